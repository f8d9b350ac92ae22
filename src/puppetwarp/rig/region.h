#pragma once

#include <puppetwarp/base/point.h>

namespace puppetwarp {

//! Whether a polygon holds a point, by the even-odd rule; a point on an edge may fall on either side.
bool inside(const Polyline& polygon, const Point& p);

//! Centre of the area inside a polygon: what a region turns about. The mean of its corners when it has no area.
Point region_centroid(const Polyline& polygon);

}  // namespace puppetwarp
