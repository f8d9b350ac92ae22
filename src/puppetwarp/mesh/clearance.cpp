#include <puppetwarp/mesh/clearance.h>

#include <algorithm>

namespace puppetwarp {

namespace {

constexpr std::size_t run_length = 8;

double cross(const Point& a, const Point& b) {
    return a.x() * b.y() - a.y() * b.x();
}

double squared_distance(const Segment& s, const Point& p) {
    const Point way = s.b - s.a;
    const double squared = way.squaredNorm();
    const double along = squared > 0 ? std::clamp(way.dot(p - s.a) / squared, 0.0, 1.0) : 0;
    return (s.a + along * way - p).squaredNorm();
}

double squared_distance(const Segment& s, const Segment& t) {
    const Point s_way = s.b - s.a, t_way = t.b - t.a;
    const double t_a = cross(s_way, t.a - s.a), t_b = cross(s_way, t.b - s.a);
    const double s_a = cross(t_way, s.a - t.a), s_b = cross(t_way, s.b - t.a);
    if (t_a * t_b < 0 && s_a * s_b < 0) return 0;
    return std::min(
        {squared_distance(s, t.a), squared_distance(s, t.b), squared_distance(t, s.a), squared_distance(t, s.b)});
}

Eigen::AlignedBox2d box_of(const Segment& s) {
    return {s.a.cwiseMin(s.b), s.a.cwiseMax(s.b)};
}

}  // namespace

double segment_distance(const Segment& s, const Segment& t) {
    return std::sqrt(squared_distance(s, t));
}

Clearance::Clearance(const Polyline& polygon) {
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        edges_.push_back({polygon[k], polygon[(k + 1) % polygon.size()]});
        if (k % run_length == 0) runs_.push_back({k, k, {}});
        runs_.back().last = k + 1;
        runs_.back().box.extend(box_of(edges_.back()));
    }
}

bool Clearance::keeps(const Segment& s, double distance) const {
    const double squared = distance * distance;
    const Eigen::AlignedBox2d box = box_of(s);
    return std::all_of(runs_.begin(), runs_.end(), [&](const Run& run) {
        if (run.box.squaredExteriorDistance(box) >= squared) return true;
        for (std::size_t e = run.first; e < run.last; ++e) {
            if (box.squaredExteriorDistance(box_of(edges_[e])) < squared && squared_distance(s, edges_[e]) < squared) {
                return false;
            }
        }
        return true;
    });
}

}  // namespace puppetwarp
