#include <puppetwarp/mesh/outline.h>

#include <algorithm>
#include <cassert>
#include <limits>

namespace puppetwarp {

namespace {

template <class Visit>
void for_each_polygon(const Outline& outline, const Visit& visit) {
    for (const OutlineComponent& component : outline.components) {
        visit(component.outer);
        for (const Polyline& hole : component.holes) visit(hole);
    }
}

// Even-odd: polygons of an outline do not cross, so holes cancel what is around them.
bool crosses_ray(const Point& a, const Point& b, const Point& p) {
    if ((a.y() > p.y()) == (b.y() > p.y())) return false;
    return p.x() < a.x() + (b.x() - a.x()) * ((p.y() - a.y()) / (b.y() - a.y()));
}

}  // namespace

Outline rectangle_outline(double width, double height) {
    assert(width > 0 && height > 0);
    return {{{{{0, 0}, {width, 0}, {width, height}, {0, height}}, {}}}};
}

double signed_area(const Polyline& polygon) {
    double doubled = 0;
    for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
        const Point a = polygon[k] - polygon[0], b = polygon[k + 1] - polygon[0];
        doubled += a.x() * b.y() - a.y() * b.x();
    }
    return doubled / 2;
}

bool contains(const Outline& outline, const Point& point) {
    bool inside = false;
    for_each_polygon(outline, [&](const Polyline& polygon) {
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            if (crosses_ray(polygon[k], polygon[(k + 1) % polygon.size()], point)) inside = !inside;
        }
    });
    return inside;
}

Point nearest_boundary_point(const Outline& outline, const Point& point) {
    double best = std::numeric_limits<double>::infinity();
    Point nearest = point;
    for_each_polygon(outline, [&](const Polyline& polygon) {
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            const Point& a = polygon[k];
            const Point edge = polygon[(k + 1) % polygon.size()] - a;
            const double squared = edge.squaredNorm();
            const double t = squared > 0 ? std::clamp((point - a).dot(edge) / squared, 0.0, 1.0) : 0.0;
            const Point candidate = a + t * edge;
            const double distance = (candidate - point).squaredNorm();
            if (distance < best) {
                best = distance;
                nearest = candidate;
            }
        }
    });
    return nearest;
}

}  // namespace puppetwarp
