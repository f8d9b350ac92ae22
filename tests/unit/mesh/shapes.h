#pragma once

#include <puppetwarp/mesh/outline.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace puppetwarp::tests {

//! Distance of a point from a shape's edge, positive inside.
using Shape = std::function<double(const Point&)>;

inline Shape disc(Point centre, double radius) {
    return [=](const Point& p) { return radius - (p - centre).norm(); };
}

//! Exact outside and inside; `half` holds half its width and height.
inline Shape turned_rectangle(Point centre, Point half, double angle_rad) {
    return [=](const Point& p) {
        const Point d = p - centre;
        const double c = std::cos(angle_rad), s = std::sin(angle_rad);
        const Point q = Point(std::abs(c * d.x() + s * d.y()), std::abs(c * d.y() - s * d.x())) - half;
        return q.maxCoeff() <= 0 ? -q.maxCoeff() : -q.cwiseMax(0).norm();
    };
}

//! A picture of the shape: each pixel's share by 16 x 16 samples, or by its centre alone when `hard`.
inline cv::Mat picture_of(const Shape& shape, int width, int height, bool hard) {
    cv::Mat matte(height, width, CV_8U);
    for (int j = 0; j < height; ++j) {
        for (int i = 0; i < width; ++i) {
            const double middle = shape({i + 0.5, j + 0.5});
            int inside = middle >= 0 ? 256 : 0;
            if (!hard && std::abs(middle) < 1) {
                inside = 0;
                for (int k = 0; k < 256; ++k) inside += shape({i + (k % 16 + 0.5) / 16, j + (k / 16 + 0.5) / 16}) >= 0;
            }
            matte.at<std::uint8_t>(j, i) = static_cast<std::uint8_t>((inside * 255 + 128) / 256);
        }
    }
    return matte;
}

//! A star-shaped blob with a wavy edge.
inline Polyline wavy_polygon(std::mt19937& random, Point centre, double radius, int points) {
    std::uniform_real_distribution<double> wave(-0.12, 0.12), phase(0, 2 * std::numbers::pi);
    const double a = wave(random), b = wave(random), c = wave(random), p = phase(random), q = phase(random);
    Polyline polygon;
    for (int k = 0; k < points; ++k) {
        const double t = 2 * std::numbers::pi * k / points;
        const double r = radius * (1 + a * std::sin(2 * t + p) + b * std::sin(5 * t + q) + c * std::sin(9 * t));
        polygon.emplace_back(centre.x() + r * std::cos(t), centre.y() + r * std::sin(t));
    }
    return polygon;
}

//! Every polygon of an outline.
inline std::vector<Polyline> polygons_of(const Outline& outline) {
    std::vector<Polyline> polygons;
    for (const OutlineComponent& component : outline.components) {
        polygons.push_back(component.outer);
        polygons.insert(polygons.end(), component.holes.begin(), component.holes.end());
    }
    return polygons;
}

inline double area_of(const Outline& outline) {
    double area = 0;
    for (const OutlineComponent& component : outline.components) {
        area += std::abs(signed_area(component.outer));
        for (const Polyline& hole : component.holes) area -= std::abs(signed_area(hole));
    }
    return area;
}

}  // namespace puppetwarp::tests
