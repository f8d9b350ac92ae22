#pragma once
// Private header.

#include <puppetwarp/base/point.h>

#include <functional>

namespace puppetwarp {

//! The convex hull, of positive area, without points along its edges. Fewer than three points where all lie on a line.
//! Andrew 1979.
Polyline convex_hull(Polyline points);

//! Of the triangles that hold all points, with sides along the edges of their convex hull or in one of 24 directions,
//! the cheapest.
//! \param hull  see `convex_hull`; at least three points.
//! \param cost  of a polygon.
Polyline enclosing_triangle(const Polyline& hull, const std::function<double(const Polyline&)>& cost);

}  // namespace puppetwarp
