#pragma once

#include <puppetwarp/mesh/contour_field.h>
#include <puppetwarp/mesh/outline.h>

#include <vector>

namespace puppetwarp {

//! Sorts contours into components and their holes; holes smaller than `min_hole_area` are filled, with whatever is
//! in them. Components and holes keep the order of `contours`.
//! \param polygons  the contours as polygons, in the same order and unit as `min_hole_area`.
Outline nested(const std::vector<Contour>& contours, std::vector<Polyline> polygons, double min_hole_area);

}  // namespace puppetwarp
