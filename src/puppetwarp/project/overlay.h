#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/project/pipeline.h>
#include <puppetwarp/rig/rig.h>
#include <puppetwarp/warp/warp.h>

#include <array>

namespace puppetwarp {

//! Draws the edges of a mesh over a picture, in the picture's depth and channels. Opaque where it draws.
//! \param positions  #V x 2, image pixels.
//! \param canvas     which part of image space `picture` shows.
void draw_mesh(Image& picture, const Eigen::MatrixX2d& positions, const Eigen::MatrixX3i& F, const Canvas& canvas);

//! How handles are drawn. Colours are red, green and blue from 0 to 1.
struct HandleStyle {
    std::array<double, 3> body{1.0, 0.75, 0.0};
    std::array<double, 3> rim{0.0, 0.0, 0.0};
    double size = 1;  //!< of lines and discs, above 0
};

//! Draws points, bones, regions and cages where the pose puts them.
//! \param scale  pixels of the picture for one of image space, above 0; the picture's upper left corner is the canvas'.
void draw_handles(Image& picture, const Rig& rig, const Pose& pose, const Canvas& canvas, double scale = 1,
                  const HandleStyle& style = {});

//! Draws over a picture of `render`: its mesh, or its handles as the pose puts them.
void draw_mesh(Rendered& rendered);
void draw_handles(Rendered& rendered, const Pose& pose);

}  // namespace puppetwarp
