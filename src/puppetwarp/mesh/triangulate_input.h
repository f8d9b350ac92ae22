#pragma once

#include <puppetwarp/mesh/outline.h>
#include <puppetwarp/mesh/segment_grid.h>

#include <optional>
#include <vector>

namespace puppetwarp {

//! The boundary polygons of an outline without points that add nothing: repeated ones and spikes of no area.
//! Every polygon has at least three corners, and no two edges meet but at the corners of their polygon.
//! \throw InvalidInput  no area, a coordinate that is not finite, edges that cross or touch (says where).
std::vector<Polyline> sound_boundaries(const Outline& outline);

//! What a mesh has edges along and vertices at, besides its boundary.
struct ClippedConstraints {
    std::vector<Segment> segments;
    std::vector<Point> points;  //!< on no segment
};

//! The parts of polylines that lie inside, at least `clearance` away from every boundary edge: closer ones would force
//! needlessly small triangles. A polyline of one point is a point. Endpoints and points nearer than a tenth of
//! `clearance` to each other become one; a point so near to one segment divides it at the nearest place.
//! \throw InvalidInput  a coordinate that is not finite.
ClippedConstraints clipped_constraints(const std::vector<Polyline>& constraints,
                                       const std::vector<Polyline>& boundaries, double clearance);

//! A point inside the hole `polygon` and outside the components that lie in it, as far from edges as a few tries
//! find; none when the hole has no room for a point.
std::optional<Point> point_in_hole(const Polyline& polygon, const std::vector<Polyline>& boundaries);

}  // namespace puppetwarp
