#include "shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace samples {

namespace {

constexpr float kDegree = 3.14159265F / 180;

float cross(Vec a, Vec b) {
    return a.x * b.y - a.y * b.x;
}

// The share of the way from a to b, in [0, 1], that is nearest to p.
float nearest_share(Vec p, Vec a, Vec b) {
    const Vec ab = b - a;
    const float squared = ab.dot(ab);
    return squared > 0 ? std::clamp((p - a).dot(ab) / squared, 0.0F, 1.0F) : 0.0F;
}

}  // namespace

float length(Vec v) {
    return std::sqrt(v.dot(v));
}

Vec direction(float degrees) {
    return {std::cos(degrees * kDegree), std::sin(degrees * kDegree)};
}

float smooth_step(float from, float to, float value) {
    const float t = std::clamp((value - from) / (to - from), 0.0F, 1.0F);
    return t * t * (3 - 2 * t);
}

float mix(float a, float b, float share) {
    return a + (b - a) * share;
}

cv::Vec3f mix(const cv::Vec3f& a, const cv::Vec3f& b, float share) {
    return a + (b - a) * share;
}

float circle(Vec p, Vec centre, float radius) {
    return length(p - centre) - radius;
}

float ellipse(Vec p, Vec centre, Vec radii, float degrees) {
    const Vec axis = direction(degrees), d = p - centre;
    const Vec q(d.dot(axis), cross(axis, d));
    const Vec unit(q.x / radii.x, q.y / radii.y);
    const float k = length(unit), slope = length({unit.x / radii.x, unit.y / radii.y});
    return slope > 0 ? k * (k - 1) / slope : -std::min(radii.x, radii.y);
}

float rounded_box(Vec p, Vec centre, Vec half_size, float corner) {
    const Vec d(std::abs(p.x - centre.x) - half_size.x + corner, std::abs(p.y - centre.y) - half_size.y + corner);
    return length({std::max(d.x, 0.0F), std::max(d.y, 0.0F)}) + std::min(std::max(d.x, d.y), 0.0F) - corner;
}

float capsule(Vec p, Vec a, Vec b, float radius_a, float radius_b) {
    // The straight sides lean by the angle whose sine is `lean`; the nearest point of the axis moves with it.
    const Vec ab = b - a, axis = ab * (1 / length(ab));
    const float lean = (radius_a - radius_b) / length(ab);
    const float along = (p - a).dot(axis), aside = std::abs(cross(axis, p - a));
    const float share = std::clamp((along + aside * lean / std::sqrt(1 - lean * lean)) / length(ab), 0.0F, 1.0F);
    return length(p - (a + ab * share)) - mix(radius_a, radius_b, share);
}

float polygon(Vec p, const std::vector<Vec>& corners) {
    float nearest = std::numeric_limits<float>::max();
    bool inside = false;
    for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
        const Vec a = corners[j], b = corners[i];
        nearest = std::min(nearest, length(p - (a + (b - a) * nearest_share(p, a, b))));
        if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)) inside = !inside;
    }
    return inside ? -nearest : nearest;
}

float join(float a, float b, float fillet) {
    const float overlap = std::max(fillet - std::abs(a - b), 0.0F);
    return std::min(a, b) - overlap * overlap / (4 * fillet);
}

Curve::Curve(std::vector<CurvePoint> points)
    : points_(std::move(points)), low_(points_.front().at), high_(points_.front().at) {
    for (const CurvePoint& point : points_) {
        low_ = {std::min(low_.x, point.at.x - point.radius), std::min(low_.y, point.at.y - point.radius)};
        high_ = {std::max(high_.x, point.at.x + point.radius), std::max(high_.y, point.at.y + point.radius)};
    }
}

Curve Curve::part(std::size_t first, std::size_t last) const {
    const auto begin = points_.begin();
    return Curve({begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(last) + 1});
}

float Curve::distance_to_box(Vec p) const {
    return length({std::max({low_.x - p.x, p.x - high_.x, 0.0F}), std::max({low_.y - p.y, p.y - high_.y, 0.0F})});
}

Curve smooth_curve(const std::vector<CurvePoint>& knots, int steps) {
    std::vector<CurvePoint> curve;
    const int last = static_cast<int>(knots.size()) - 1;
    const auto knot = [&](int i) { return knots[static_cast<std::size_t>(std::clamp(i, 0, last))]; };
    for (int i = 0; i < last; ++i) {
        const Vec before = knot(i - 1).at, a = knot(i).at, b = knot(i + 1).at, after = knot(i + 2).at;
        for (int step = 0; step < steps; ++step) {
            const float t = static_cast<float>(step) / static_cast<float>(steps);
            const Vec at = (a * 2 + (b - before) * t + (before * 2 - a * 5 + b * 4 - after) * (t * t) +
                            (a * 3 - before - b * 3 + after) * (t * t * t)) *
                           0.5F;
            curve.push_back({at, mix(knot(i).radius, knot(i + 1).radius, t)});
        }
    }
    curve.push_back(knots.back());
    return Curve(std::move(curve));
}

CurvePlace nearest_on_curve(Vec p, const Curve& curve) {
    CurvePlace best;
    best.distance = curve.distance_to_box(p);
    if (best.distance > 64) return best;
    const std::vector<CurvePoint>& points = curve.points();
    best.distance = std::numeric_limits<float>::max();
    float walked = 0;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const CurvePoint &a = points[i], &b = points[i + 1];
        const float share = nearest_share(p, a.at, b.at), step = length(b.at - a.at);
        const Vec offset = p - (a.at + (b.at - a.at) * share);
        const float radius = mix(a.radius, b.radius, share), distance = length(offset) - radius;
        if (distance < best.distance) {
            const float side = cross(b.at - a.at, offset) > 0 ? 1.0F : -1.0F;
            best = {distance, walked + step * share, side * length(offset) / std::max(radius, 1e-3F), radius};
        }
        walked += step;
    }
    return best;
}

float tube(Vec p, const Curve& curve) {
    return nearest_on_curve(p, curve).distance;
}

float tube_height(const CurvePlace& place) {
    return place.radius * std::sqrt(std::max(0.0F, 1 - place.across * place.across));
}

}  // namespace samples
