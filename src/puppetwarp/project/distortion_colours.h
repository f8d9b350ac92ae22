#pragma once
// Private header.

#include <puppetwarp/base/picture_text.h>
#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/warp/warp.h>

namespace puppetwarp {

//! Distortions from here on have the darkest colour.
inline constexpr double darkest_distortion = 2;

//! Colour of a triangle's distortion. Its depth is the symmetric measure max(s1, 1 / s2) on a logarithmic scale, from
//! white at 1 to the darkest at `darkest_distortion`. Its hue is where that comes from: red where the triangle only
//! grows, blue where it only shrinks, grey where it is stretched as much one way as it is squeezed the other, mixed by
//! (log s1 + log s2) / (log s1 - log s2) between these. Folded or collapsed: magenta. The ramps are ColorBrewer's RdBu
//! and RdGy (Harrower & Brewer 2003), with white for their middle.
//! \param larger, smaller  singular values of the triangle's map, the smaller at most 0 where it is folded.
Rgb distortion_colour(double larger, double smaller);

//! Fills each moved triangle with the colour of its distortion; folded ones lie on top. Outlines the mesh's border.
//! \param picture  8-bit RGB, drawn over without antialiasing.
//! \param moved    #V x 2, image space.
//! \param canvas   whose upper left corner is the picture's.
//! \param scale    pixels of the picture for one of image space.
void draw_distortion(cv::Mat& picture, const TriangleMesh& mesh, const Eigen::MatrixX2d& moved, const Canvas& canvas,
                     double scale);

//! Height of what `draw_distortion_legend` draws, px.
int distortion_legend_height();

//! Draws what the colours mean, with numbers, at most `width_px` wide. \param x, y  upper left corner.
void draw_distortion_legend(cv::Mat& picture, int x, int y, int width_px);

}  // namespace puppetwarp
