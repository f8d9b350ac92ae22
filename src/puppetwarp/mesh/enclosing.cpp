#include <puppetwarp/mesh/enclosing.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace puppetwarp {

namespace {

double cross(const Point& a, const Point& b) {
    return a.x() * b.y() - a.y() * b.x();
}

// A line with all points on its left, in its direction; both sides are those of a polygon of positive area.
struct Side {
    Point from, along;
};

Point crossing(const Side& s, const Side& t) {
    return s.from + s.along * (cross(t.from - s.from, t.along) / cross(s.along, t.along));
}

std::vector<Side> sides_around(const Polyline& hull) {
    std::vector<Side> sides;
    for (std::size_t k = 0; k < hull.size(); ++k) {
        sides.push_back({hull[k], (hull[(k + 1) % hull.size()] - hull[k]).normalized()});
    }
    constexpr int directions = 24;
    for (int k = 0; k < directions; ++k) {
        const double angle = 2 * std::numbers::pi * k / directions;
        const Point along(std::cos(angle), std::sin(angle));
        const auto outermost = std::min_element(hull.begin(), hull.end(), [&](const Point& a, const Point& b) {
            return cross(along, a) < cross(along, b);
        });
        sides.push_back({*outermost, along});
    }
    return sides;
}

}  // namespace

Polyline convex_hull(Polyline points) {
    std::sort(points.begin(), points.end(),
              [](const Point& a, const Point& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3) return points;
    Polyline hull;
    const auto add = [&](const Point& p, std::size_t least) {
        while (hull.size() >= least && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0) {
            hull.pop_back();
        }
        hull.push_back(p);
    };
    for (const Point& p : points) add(p, 2);
    const std::size_t lower = hull.size() + 1;
    for (std::size_t k = points.size() - 1; k-- > 0;) add(points[k], lower);
    hull.pop_back();
    return hull;
}

Polyline enclosing_triangle(const Polyline& hull, const std::function<double(const Polyline&)>& cost) {
    const std::vector<Side> sides = sides_around(hull);
    // Sides that are nearly parallel meet nowhere near.
    constexpr double parallel = 0.02;
    const auto turns_left = [&](const Side& s, const Side& t) { return cross(s.along, t.along) > parallel; };
    Polyline best;
    double least = std::numeric_limits<double>::infinity();
    for (const Side& a : sides) {
        for (const Side& b : sides) {
            if (!turns_left(a, b)) continue;
            for (const Side& c : sides) {
                if (!turns_left(b, c) || !turns_left(c, a)) continue;
                const Polyline triangle{crossing(a, b), crossing(b, c), crossing(c, a)};
                const double found = cost(triangle);
                if (found < least) {
                    least = found;
                    best = triangle;
                }
            }
        }
    }
    return best;
}

}  // namespace puppetwarp
