#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/base/progress.h>
#include <puppetwarp/mesh/triangle_mesh.h>

#include <Eigen/Geometry>

#include <string>
#include <string_view>
#include <vector>

namespace puppetwarp {

enum class Interpolation { nearest, bilinear, bicubic, lanczos3 };

std::vector<std::string> interpolation_names();
//! \throw InvalidInput  unknown name (lists the known ones).
Interpolation interpolation_from_name(std::string_view name);

//! The part of image space that an output picture shows, in whole pixels.
struct Canvas {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;
};

//! What becomes of triangles that are turned over, which show the picture mirrored.
enum class BackFaces { hide, show };

std::string back_faces_name(BackFaces back_faces);
//! \throw InvalidInput  unknown name (lists the known ones).
BackFaces back_faces_from_name(std::string_view name);

struct WarpOptions {
    Interpolation interpolation = Interpolation::bicubic;
    Canvas canvas;        //!< of no size: the source's own
    bool linear = false;  //!< in linear light, by the tone curves of the picture's profile or sRGB's; floats are linear
    //! What the canvas stands for, when that ends between pixels (`scaled_canvas`): a pixel that it ends in counts as
    //! covered when its part inside is. Empty: the canvas itself.
    Eigen::AlignedBox2d frame = {};
    BackFaces back_faces = BackFaces::hide;
    Eigen::VectorXd depth = {};  //!< #V, larger is nearer to the viewer; empty: all alike. See `painters_order`
};

//! Draws a picture through moved triangles.
//!
//! A pixel belongs to the triangle that holds its centre (one triangle, also on shared edges). Triangles are drawn over
//! each other in `painters_order`, without depths in the order of their indices; flipped ones only on demand, and those
//! that have no area not at all. Sampling is premultiplied; where a triangle moves by whole pixels its pixels are
//! copied. Pixels that no triangle covers are transparent: the output has alpha when the input has, or when some output
//! pixel is uncovered.
//! Beyond its border a picture without alpha repeats its outermost pixels; one with alpha fades out over half a pixel.
//! Where a triangle shrinks by more than 1.5, a pixel is the mean of up to 64 samples, above a factor of about 8 of
//! samples of a pyramid. Pixels that the border of the mesh crosses are as opaque as it covers them, but for triangles
//! that move by whole pixels. (Neither for `nearest`.)
//! The same bytes for any number of threads.
//! \param moved  #V x 2 positions of the vertices of `rest`.
//! \throw InvalidInput  positions or depths that are not finite or not one for each vertex; a triangle that names a
//!        missing vertex; a canvas of more than 2^31 - 1 pixels, of no size along one axis, or more than 2^30 px away.
//! \throw MachineFault  not enough memory for the canvas.
Image warp(const Image& image, const TriangleMesh& rest, const Eigen::MatrixX2d& moved, const WarpOptions& options,
           Progress& progress);
Image warp(const Image& image, const TriangleMesh& rest, const Eigen::MatrixX2d& moved,
           const WarpOptions& options = {});

//! The smallest canvas that holds the source's own and all moved positions, but for a solver's noise of 5e-5 px.
//! \throw InvalidInput  positions that are not finite, or that ask for more than `warp` can do.
Canvas grown_canvas(int width, int height, const Eigen::MatrixX2d& moved);

//! The pixels of a plane magnified by `x_scale` and `y_scale` whose centres lie in `canvas`: what a picture of the
//! canvas has at that scale. At scale 1 the canvas itself.
//! \throw InvalidInput  there are none, or more than `warp` can do.
Canvas scaled_canvas(const Canvas& canvas, double x_scale, double y_scale);

//! Where a canvas lies on a plane magnified by `scale`, exactly: for `WarpOptions::frame`.
Eigen::AlignedBox2d scaled_frame(const Canvas& canvas, double scale);

}  // namespace puppetwarp
