#pragma once

#include <Eigen/Core>

#include <vector>

namespace puppetwarp {

//! A point of image space: pixels of the source picture, x right, y down; the centre of pixel (i, j) is (i + 0.5, j +
//! 0.5).
using Point = Eigen::Vector2d;

//! Points joined by straight edges. Open as a constraint of a triangulation; closed, without repeating
//! the first point, as the boundary of a polygon.
using Polyline = std::vector<Point>;

}  // namespace puppetwarp
