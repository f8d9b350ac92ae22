#include <puppetwarp/mesh/triangulate_input.h>

#include <puppetwarp/base/errors.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>

namespace puppetwarp {

namespace {

std::string text(const Point& point) {
    char buffer[64];
    std::snprintf(buffer, sizeof(buffer), "(%.6g, %.6g)", point.x(), point.y());
    return buffer;
}

double cross(const Point& a, const Point& b) {
    return a.x() * b.y() - a.y() * b.x();
}

// Coordinates beyond this lose the sub-pixel, and squares of squares overflow in time.
constexpr double largest_coordinate = 1e9;

void require_finite(const Polyline& points, const char* subject) {
    for (const Point& point : points) {
        if (!point.allFinite()) throw InvalidInput(subject, "a coordinate is not a finite number");
        if (point.lpNorm<Eigen::Infinity>() > largest_coordinate) {
            throw InvalidInput(subject, "the point " + text(point) + " is too far out", "keep within 1e9 pixels");
        }
    }
}

// Whether going a, b, c turns right back at b.
bool is_spike(const Point& a, const Point& b, const Point& c) {
    return cross(b - a, c - b) == 0 && (b - a).dot(c - b) < 0;
}

Polyline cleaned(const Polyline& polygon) {
    Polyline clean;
    const auto settle = [&] {
        for (;;) {
            const std::size_t n = clean.size();
            if (n >= 2 && clean[n - 1] == clean[n - 2]) {
                clean.pop_back();
            } else if (n >= 3 && is_spike(clean[n - 3], clean[n - 2], clean[n - 1])) {
                clean.erase(clean.end() - 2);
            } else {
                return;
            }
        }
    };
    for (const Point& point : polygon) {
        clean.push_back(point);
        settle();
    }
    std::size_t first = 0, last = clean.size();
    while (last - first >= 3) {  // the same where the end meets the start
        if (clean[last - 1] == clean[first] || is_spike(clean[last - 2], clean[last - 1], clean[first])) {
            --last;
        } else if (is_spike(clean[last - 1], clean[first], clean[first + 1])) {
            ++first;
        } else {
            break;
        }
    }
    return {clean.begin() + static_cast<std::ptrdiff_t>(first), clean.begin() + static_cast<std::ptrdiff_t>(last)};
}

std::vector<Segment> edges_of(const std::vector<Polyline>& polygons) {
    std::vector<Segment> edges;
    for (const Polyline& polygon : polygons) {
        for (std::size_t k = 0; k < polygon.size(); ++k)
            edges.push_back({polygon[k], polygon[(k + 1) % polygon.size()]});
    }
    return edges;
}

void require_simple(const std::vector<Polyline>& polygons) {
    const std::vector<Segment> edges = edges_of(polygons);
    if (const auto pairs = meeting_pairs(edges); !pairs.empty()) {
        throw InvalidInput(
            "outline",
            "it crosses or touches itself at " + text(meeting_point(edges[pairs[0].first], edges[pairs[0].second])),
            "move its points apart there");
    }
    std::vector<Point> corners;
    for (const Polyline& polygon : polygons) corners.insert(corners.end(), polygon.begin(), polygon.end());
    const auto less = [](const Point& a, const Point& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); };
    std::sort(corners.begin(), corners.end(), less);
    if (const auto twice = std::adjacent_find(corners.begin(), corners.end()); twice != corners.end()) {
        throw InvalidInput("outline", "it touches itself at " + text(*twice), "move its points apart there");
    }
}

Point nearest_on(const Segment& s, const Point& p) {
    const Point way = s.b - s.a;
    const double squared = way.squaredNorm();
    return squared > 0 ? Point(s.a + std::clamp(way.dot(p - s.a) / squared, 0.0, 1.0) * way) : s.a;
}

// Where s + t (e - s), t in [0, 1], is closer than `radius` to the edge: one interval, as the surrounding of an edge
// is convex.
struct Interval {
    double from, to;
};

std::optional<Interval> near_interval(const Segment& s, const Segment& edge, double radius) {
    Interval near{2, -1};
    const auto take = [&](double from, double to) {
        from = std::max(from, 0.0);
        to = std::min(to, 1.0);
        if (from > to) return;
        near.from = std::min(near.from, from);
        near.to = std::max(near.to, to);
    };
    const Point way = s.b - s.a;
    const double squared = way.squaredNorm();
    for (const Point& end : {edge.a, edge.b}) {
        const double middle = (end - s.a).dot(way) / squared;
        const double off = cross(way, end - s.a) / std::sqrt(squared);
        if (std::abs(off) > radius) continue;
        const double half = std::sqrt((radius * radius - off * off) / squared);
        take(middle - half, middle + half);
    }
    // The strip along the edge: cut [0, 1] by its four sides.
    const Point along = (edge.b - edge.a).normalized();
    const double length = (edge.b - edge.a).norm();
    double from = 0, to = 1;
    const auto cut = [&](double at_start, double slope, double low, double high) {
        if (slope == 0) {
            if (at_start < low || at_start > high) to = -1;
            return;
        }
        const double a = (low - at_start) / slope, b = (high - at_start) / slope;
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    };
    cut(along.dot(s.a - edge.a), along.dot(way), 0, length);
    cut(cross(along, s.a - edge.a), cross(along, way), -radius, radius);
    take(from, to);
    if (near.from > near.to) return std::nullopt;
    return near;
}

bool inside(const std::vector<Polyline>& boundaries, const Point& point) {
    Outline parts;
    for (const Polyline& polygon : boundaries) parts.components.push_back({polygon, {}});
    return contains(parts, point);
}

void clip(const Segment& s, const std::vector<Polyline>& boundaries, const std::vector<Segment>& edges,
          double clearance, std::vector<Segment>& kept) {
    const double length = (s.b - s.a).norm();
    if (length < 0.1 * clearance) return;
    std::vector<Interval> blocked;
    for (const Segment& edge : edges) {
        if (const auto near = near_interval(s, edge, clearance)) blocked.push_back(*near);
    }
    std::sort(blocked.begin(), blocked.end(),
              [](const Interval& a, const Interval& b) { return a.from != b.from ? a.from < b.from : a.to < b.to; });
    blocked.push_back({1, 1});
    double free_from = 0;
    for (const Interval& interval : blocked) {
        const double middle = 0.5 * (free_from + interval.from);
        const bool long_enough = (interval.from - free_from) * length >= 0.5 * clearance;
        if (long_enough && inside(boundaries, s.a + middle * (s.b - s.a))) {
            kept.push_back({free_from > 0 ? Point(s.a + free_from * (s.b - s.a)) : s.a,
                            interval.from < 1 ? Point(s.a + interval.from * (s.b - s.a)) : s.b});
        }
        free_from = std::max(free_from, interval.to);
    }
}

// Whether a point lies inside, away from every edge.
bool has_room(const Point& point, const std::vector<Polyline>& boundaries, const std::vector<Segment>& edges,
              double clearance) {
    return inside(boundaries, point) && std::none_of(edges.begin(), edges.end(), [&](const Segment& edge) {
               return (nearest_on(edge, point) - point).norm() < clearance;
           });
}

std::optional<Point> one_within(const std::vector<Point>& points, const Point& point, double distance) {
    const auto found = std::find_if(points.begin(), points.end(),
                                    [&](const Point& other) { return (other - point).norm() < distance; });
    return found == points.end() ? std::nullopt : std::optional<Point>(*found);
}

// Makes a point a vertex, a little off its place where it almost lies on a segment: beside it, round-off would make
// slivers. Where several segments pass, they meet or almost meet, and vertices are near in any case.
// \return where the vertex is.
Point take_in(const Point& point, double nearest, ClippedConstraints& kept) {
    std::vector<std::size_t> passing;
    for (std::size_t k = 0; k < kept.segments.size(); ++k) {
        if ((nearest_on(kept.segments[k], point) - point).norm() < nearest) passing.push_back(k);
    }
    if (passing.empty()) kept.points.push_back(point);
    if (passing.size() != 1) return point;
    Segment& first = kept.segments[passing[0]];
    Point middle = nearest_on(first, point);
    const Segment second{middle, first.b};
    first.b = middle;
    kept.segments.push_back(second);
    return middle;
}

}  // namespace

std::vector<Polyline> sound_boundaries(const Outline& outline) {
    std::vector<Polyline> boundaries;
    for (const OutlineComponent& component : outline.components) {
        require_finite(component.outer, "outline");
        Polyline outer = cleaned(component.outer);
        if (outer.size() < 3)
            throw InvalidInput("outline", "a part of it has no area", "give it three corners or more");
        boundaries.push_back(std::move(outer));
        for (const Polyline& hole : component.holes) {
            require_finite(hole, "outline");
            Polyline clean = cleaned(hole);
            if (clean.size() >= 3) boundaries.push_back(std::move(clean));
        }
    }
    if (boundaries.empty()) throw InvalidInput("outline", "it is empty", "choose a subject that is visible");
    require_simple(boundaries);
    return boundaries;
}

ClippedConstraints clipped_constraints(const std::vector<Polyline>& constraints,
                                       const std::vector<Polyline>& boundaries, double clearance) {
    const std::vector<Segment> edges = edges_of(boundaries);
    ClippedConstraints kept;
    std::vector<Point> lone;
    for (const Polyline& polyline : constraints) {
        require_finite(polyline, "constraint");
        for (std::size_t k = 0; k + 1 < polyline.size(); ++k) {
            clip({polyline[k], polyline[k + 1]}, boundaries, edges, clearance, kept.segments);
        }
        if (polyline.size() == 1 && has_room(polyline[0], boundaries, edges, clearance)) lone.push_back(polyline[0]);
    }
    std::vector<Point> ends;
    for (Segment& s : kept.segments) {
        for (Point* end : {&s.a, &s.b}) {
            if (const auto other = one_within(ends, *end, 0.1 * clearance)) {
                *end = *other;
            } else {
                ends.push_back(*end);
            }
        }
    }
    std::erase_if(kept.segments, [](const Segment& s) { return s.a == s.b; });
    for (const Point& point : lone) {
        if (one_within(ends, point, 0.1 * clearance)) continue;
        ends.push_back(take_in(point, 0.1 * clearance, kept));
    }
    return kept;
}

std::optional<Point> point_in_hole(const Polyline& polygon, const std::vector<Polyline>& boundaries) {
    std::vector<double> levels;
    for (const Point& point : polygon) levels.push_back(point.y());
    std::sort(levels.begin(), levels.end());
    levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
    // The highest strips between corners are the likeliest to have room.
    std::vector<std::pair<double, double>> strips;
    for (std::size_t k = 0; k + 1 < levels.size(); ++k) strips.emplace_back(levels[k] - levels[k + 1], levels[k]);
    std::sort(strips.begin(), strips.end());
    strips.resize(std::min<std::size_t>(strips.size(), 16));
    const auto crossings_at = [](const Polyline& some, double y, std::vector<double>& xs) {
        for (std::size_t k = 0; k < some.size(); ++k) {
            const Point& a = some[k];
            const Point& b = some[(k + 1) % some.size()];
            if ((a.y() > y) != (b.y() > y)) xs.push_back(a.x() + (b.x() - a.x()) * ((y - a.y()) / (b.y() - a.y())));
        }
    };
    std::optional<Point> best;
    double widest = 0;
    for (const auto& [height, bottom] : strips) {
        const double y = bottom - 0.5 * height;
        std::vector<double> own, all;
        crossings_at(polygon, y, own);
        for (const Polyline& boundary : boundaries) crossings_at(boundary, y, all);
        std::sort(own.begin(), own.end());
        std::sort(all.begin(), all.end());
        for (std::size_t k = 0; k + 1 < all.size(); ++k) {
            const double x = 0.5 * (all[k] + all[k + 1]);
            const auto before = std::lower_bound(own.begin(), own.end(), x) - own.begin();
            const double room = std::min(all[k + 1] - all[k], -height);
            // Inside the polygon, but an even number of boundaries in: outside the subject.
            if (before % 2 == 1 && k % 2 == 1 && room > widest) {
                widest = room;
                best = Point(x, y);
            }
        }
    }
    return best;
}

}  // namespace puppetwarp
