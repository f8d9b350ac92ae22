#pragma once

#include <puppetwarp/base/point.h>

#include <opencv2/core/mat.hpp>

#include <vector>

namespace puppetwarp {

//! One connected piece of a silhouette.
struct OutlineComponent {
    Polyline outer;               //!< closed, positive area in image space (x right, y down)
    std::vector<Polyline> holes;  //!< closed, negative area
};

//! The silhouette of a subject as polygons that neither touch nor cross each other or themselves.
struct Outline {
    std::vector<OutlineComponent> components;
};

struct OutlineOptions {
    double max_deviation_px = 0.5;  //!< how far simplification may move the outline, above 0
    double expand_px = 2;           //!< how far the outline is grown, at least 0
    double min_hole_area_px2 = 0;   //!< smaller holes are filled; at least 0
};

//! The smooth sub-pixel outline of a matte, grown by `expand_px` and, where that is not enough, as far as needed to
//! hold every pixel (as a square) whose coverage is above 0, clipped to nothing: it may leave the picture.
//! Components whose grown outlines meet become one.
//! \param matte  #rows x #cols, one channel, CV_8U, CV_16U or CV_32F.
//! \throw InvalidInput  no pixel has coverage.
Outline trace_outline(const cv::Mat& matte, const OutlineOptions& options = {});

//! The outline [0, width] x [0, height] of a whole picture.
Outline rectangle_outline(double width, double height);

//! Signed area, positive when the polygon is oriented as an `outer` boundary. px^2.
double signed_area(const Polyline& polygon);

//! True when `point` is inside a component and in none of its holes.
bool contains(const Outline& outline, const Point& point);

//! The point of the outline's boundary that is nearest to `point`.
Point nearest_boundary_point(const Outline& outline, const Point& point);

}  // namespace puppetwarp
