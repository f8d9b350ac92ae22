#pragma once
// Private header.

#include <puppetwarp/base/point.h>

#include <algorithm>

namespace puppetwarp {

//! Of the point of a segment that is nearest to another: where it lies and how far away it is.
struct SegmentFoot {
    double along = 0;     //!< share of the way from a to b, in [0, 1]
    double distance = 0;  //!< px
};

//! \param a, b  ends of the segment; may be one place.
inline SegmentFoot segment_foot(const Point& a, const Point& b, const Point& p) {
    const Point ab = b - a;
    const double length2 = ab.squaredNorm();
    const double along = length2 > 0 ? std::clamp(ab.dot(p - a) / length2, 0.0, 1.0) : 0;
    return {along, (a + along * ab - p).norm()};
}

}  // namespace puppetwarp
