#pragma once
// Private header.

#include <puppetwarp/base/picture_text.h>
#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/warp/warp.h>

namespace puppetwarp {

//! Colour of a weight: white at 0 over yellow and red to dark red at 1 (ColorBrewer's YlOrRd, Harrower & Brewer 2003,
//! with white at its start); below 0 light blue to dark blue at -0.3, above 1 violet, brighter up to 1.3.
Rgb weight_colour(double weight);

//! Fills each triangle with the colours of the weights interpolated over it, with iso-lines at every tenth between 0
//! and 1, the one at 1/2 wider.
//! \param picture  8-bit RGB, drawn over.
//! \param weight   #V.
//! \param canvas   whose upper left corner is the picture's.
//! \param scale    pixels of the picture for one of image space.
void draw_weight(cv::Mat& picture, const TriangleMesh& mesh, const Eigen::VectorXd& weight, const Canvas& canvas,
                 double scale);

//! Height of what `draw_weight_legend` draws, px.
int weight_legend_height();

//! Draws what the colours mean, with numbers, at most `width_px` wide. \param x, y  upper left corner.
void draw_weight_legend(cv::Mat& picture, int x, int y, int width_px);

}  // namespace puppetwarp
