#pragma once

#include <puppetwarp/base/point.h>

#include <functional>
#include <vector>

namespace puppetwarp {

//! Closed polygons with fewer points: some of their own, the others within `tolerance` of the new edges. Polygons
//! that neither touch nor cross themselves or each other still do not.
//! \param loops    simple, disjoint, at least four points each.
//! \param blocked  true when an edge from one point to another may not be; edges of `loops` are used anyway.
//! Douglas & Peucker 1973, then the edges that are blocked or meet others are divided again until none is left.
std::vector<Polyline> simplify(const std::vector<Polyline>& loops, double tolerance,
                               const std::function<bool(const Point&, const Point&)>& blocked);

}  // namespace puppetwarp
