#include <puppetwarp/rig/region.h>

#include <cmath>

namespace puppetwarp {

namespace {

double cross(const Point& a, const Point& b) {
    return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

bool inside(const Polyline& polygon, const Point& p) {
    bool in = false;
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
        const Point& a = polygon[i];
        const Point& b = polygon[j];
        if ((a.y() > p.y()) == (b.y() > p.y())) continue;
        if (p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y())) in = !in;
    }
    return in;
}

Point region_centroid(const Polyline& polygon) {
    // About the mean of the corners, so that a place far from the origin costs no digits.
    Point middle = Point::Zero();
    for (const Point& corner : polygon) middle += corner / static_cast<double>(polygon.size());
    double area = 0, absolute = 0;
    Point moment = Point::Zero();
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
        const Point a = polygon[j] - middle, b = polygon[i] - middle;
        const double twice = cross(a, b);
        area += twice;
        absolute += std::abs(twice);
        moment += twice * (a + b) / 3;
    }
    constexpr double no_area = 1e-9;
    if (!(std::abs(area) > no_area * absolute)) return middle;
    return middle + moment / area;
}

}  // namespace puppetwarp
