#include <puppetwarp/weights/cage_polygon.h>

#include <puppetwarp/weights/segment_foot.h>

#include <limits>

namespace puppetwarp {

CageFoot nearest_foot(const Polyline& cage, const Point& p) {
    CageFoot nearest{0, 0, std::numeric_limits<double>::infinity()};
    for (std::size_t k = 0; k < cage.size(); ++k) {
        const SegmentFoot foot = segment_foot(cage[k], cage[k + 1 < cage.size() ? k + 1 : 0], p);
        if (foot.distance < nearest.distance) nearest = {k, foot.along, foot.distance};
    }
    return nearest;
}

double diagonal(const Polyline& cage) {
    Point low = cage.front(), high = low;
    for (const Point& corner : cage) {
        low = low.cwiseMin(corner);
        high = high.cwiseMax(corner);
    }
    return (high - low).norm();
}

}  // namespace puppetwarp
