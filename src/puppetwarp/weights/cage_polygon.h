#pragma once
// Private header: what the coordinates in closed form share.

#include <puppetwarp/base/point.h>

#include <cstddef>

namespace puppetwarp {

//! A place this share of the cage's diagonal from an edge is on it: nearer, the angle under which the edge is seen
//! tells no more on which side the place is.
inline constexpr double on_cage_share = 1e-11;

//! Of the place on a cage that is nearest to another.
struct CageFoot {
    std::size_t edge = 0;  //!< from corner `edge` to the next
    double along = 0;      //!< share of the way along it, in [0, 1]
    double distance = 0;   //!< px
};

//! Ties go to the first edge.
CageFoot nearest_foot(const Polyline& cage, const Point& p);

//! Length of the diagonal of a polygon's bounding box. px
double diagonal(const Polyline& cage);

}  // namespace puppetwarp
