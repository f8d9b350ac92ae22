#pragma once

#include "scenes.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

// A second warp, slow and obvious: every pixel centre is tried against every triangle, everything is double and
// premultiplied, colours are divided by alpha once, at the very end.
namespace puppetwarp::testing {

using Premultiplied = std::array<double, 5>;  // colour times alpha in [0], [1], [2]; alpha in [3]; [4]: ambiguous

class Reference {
public:
    Reference(const Image& image, const TriangleMesh& rest, const Eigen::MatrixX2d& moved, const WarpOptions& options)
        : image_(image), rest_(rest), moved_(moved), options_(options) {
        if (options_.canvas.width == 0) options_.canvas = {0, 0, image.width(), image.height()};
        find_border();
        for (Eigen::Index f = 0; f < rest.F.rows(); ++f) {
            double depth = 0;
            if (options.depth.size() > 0)
                for (int k = 0; k < 3; ++k) depth += options.depth(rest.F(f, k));
            order_.emplace(depth, f);
        }
    }

    //! Premultiplied, alpha in [0, 1], colour in the picture's numbers or as light. [4] is set where an edge passes too
    //! near for floating point to decide, and in pixels that the mesh may cover in part.
    Premultiplied at(int column, int row) const {
        const double x = options_.canvas.x + column + 0.5, y = options_.canvas.y + row + 0.5;
        Premultiplied below{};
        if (near_border({x, y})) below[4] = 1;
        for (const auto& [depth, f] : order_) {
            const Corners to = corners(moved_, f), from = corners(rest_, f);
            const double area = cross(to, 0, 1, to[2]), rest_area = cross(from, 0, 1, from[2]);
            if (area == 0 || rest_area == 0) continue;
            if (area * rest_area < 0 && options_.back_faces == BackFaces::hide) continue;
            const Eigen::Vector2d p(x, y);
            const double w0 = cross(to, 1, 2, p) / area, w1 = cross(to, 2, 0, p) / area, w2 = cross(to, 0, 1, p) / area;
            const double least = std::min({w0, w1, w2});
            const double distance = least * std::abs(area) / longest_side(to);
            if (std::abs(distance) < 1e-4) below[4] = 1;
            if (least < 0) continue;
            const double ambiguous = below[4];
            const Premultiplied front = sample_triangle(to, from, p);
            below = over(front, below);
            below[4] = std::max(front[4], ambiguous);
        }
        return below;
    }

    //! The number that is stored for a blended one.
    double stored(double blended) const {
        if (!decodes()) return blended;
        const double x = blended / image_.full_value();
        return image_.full_value() * (x <= 0.0031308 ? x * 12.92 : 1.055 * std::pow(x, 1 / 2.4) - 0.055);
    }

private:
    using Corners = std::array<Eigen::Vector2d, 3>;

    // Edges with one drawn triangle, or two that lie on the same side.
    void find_border() {
        std::map<std::pair<int, int>, std::array<int, 2>> triangles;
        for (Eigen::Index f = 0; f < rest_.F.rows(); ++f) {
            const Corners to = corners(moved_, f), from = corners(rest_, f);
            const double sign = cross(to, 0, 1, to[2]) * cross(from, 0, 1, from[2]);
            if (sign == 0 || (sign < 0 && options_.back_faces == BackFaces::hide)) continue;
            for (int k = 0; k < 3; ++k) {
                ++triangles[std::minmax({rest_.F(f, k), rest_.F(f, (k + 1) % 3)})][sign < 0 ? 1 : 0];
            }
        }
        for (const auto& [edge, count] : triangles) {
            if (count[0] == 1 || count[1] == 1) border_.push_back(edge);
        }
    }

    bool near_border(const Eigen::Vector2d& p) const {
        if (options_.interpolation == Interpolation::nearest) return false;
        return std::any_of(border_.begin(), border_.end(), [&](const std::pair<int, int>& edge) {
            const Eigen::Vector2d a = moved_.row(edge.first), ab = moved_.row(edge.second).transpose() - a;
            const double t = std::clamp((p - a).dot(ab) / std::max(ab.squaredNorm(), 1e-300), 0.0, 1.0);
            return (a + t * ab - p).norm() < 0.75;
        });
    }

    Corners corners(const TriangleMesh& mesh, Eigen::Index f) const { return corners(mesh.V, f); }
    Corners corners(const Eigen::MatrixX2d& V, Eigen::Index f) const {
        return {V.row(rest_.F(f, 0)), V.row(rest_.F(f, 1)), V.row(rest_.F(f, 2))};
    }
    static double cross(const Corners& c, std::size_t i, std::size_t j, const Eigen::Vector2d& p) {
        const Eigen::Vector2d a = c[j] - c[i], b = p - c[i];
        return a.x() * b.y() - a.y() * b.x();
    }
    static double longest_side(const Corners& c) {
        return std::max({(c[1] - c[0]).norm(), (c[2] - c[1]).norm(), (c[0] - c[2]).norm()});
    }

    static Premultiplied over(const Premultiplied& front, const Premultiplied& back) {
        Premultiplied result{};
        for (std::size_t c = 0; c < 4; ++c) result[c] = front[c] + back[c] * (1 - front[3]);
        return result;
    }

    Premultiplied sample_triangle(const Corners& to, const Corners& from, const Eigen::Vector2d& p) const {
        Eigen::Matrix2d A, B;
        A << to[1] - to[0], to[2] - to[0];
        B << from[1] - from[0], from[2] - from[0];
        const Eigen::Matrix2d J = B * A.inverse();
        const Comb x = comb(J.col(0).norm()), y = comb(J.col(1).norm());
        Premultiplied mean{};
        if (x.samples * y.samples > 64) return {0, 0, 0, 0, 1};  // the pyramid's: tested against averages
        for (int j = 0; j < y.samples; ++j) {
            for (int i = 0; i < x.samples; ++i) {
                const Eigen::Vector2d q = p + Eigen::Vector2d((i - (x.samples - 1) / 2.0) * x.distance,
                                                              (j - (y.samples - 1) / 2.0) * y.distance);
                const Premultiplied one = sample(from[0] + J * (q - to[0]));
                for (std::size_t c = 0; c < 5; ++c) mean[c] += one[c] / (x.samples * y.samples);
            }
        }
        return within_range(mean, mean[4]);
    }

    // Samples along one axis, for a step of `a` source pixels: as footprint.h has it, up to 8.
    struct Comb {
        int samples;
        double distance;
    };
    Comb comb(double a) const {
        if (a <= 1.5 || options_.interpolation == Interpolation::nearest) return {1, 0};
        const int n = static_cast<int>(std::ceil(a - 1e-9));
        const double less = options_.interpolation == Interpolation::bilinear  ? 1.7
                            : options_.interpolation == Interpolation::bicubic ? 0.4
                                                                               : 0;
        const double variance = a >= 2 ? a * a - less : (a * a - 2.25) / 1.75 * (4 - less);
        return {n, std::sqrt(variance / (n * n - 1)) / a};
    }

    Premultiplied pixel(int x, int y) const {
        x = std::clamp(x, 0, image_.width() - 1);
        y = std::clamp(y, 0, image_.height() - 1);
        Premultiplied result{};
        const int channels = image_.pixels.channels(), colours = channels <= 2 ? 1 : 3;
        result[3] = image_.has_alpha() ? value_at(image_, x, y, channels - 1) / image_.full_value() : 1;
        for (int c = 0; c < colours; ++c) {
            result[static_cast<std::size_t>(c)] = blended(value_at(image_, x, y, c)) * result[3];
        }
        return result;
    }

    bool decodes() const { return options_.linear && image_.pixels.depth() != CV_32F; }

    // The number that is blended for a stored one: itself, or by sRGB's curve.
    double blended(double stored) const {
        if (!decodes()) return stored;
        const double x = stored / image_.full_value();
        return image_.full_value() * (x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
    }

    // Weights of the six pixels from x - 2 on, for a position `f` right of pixel x.
    using Weights = std::array<double, 6>;
    static Weights weights(Interpolation interpolation, double f) {
        Weights w{};
        for (std::size_t k = 0; k < 6; ++k) w[k] = kernel(interpolation, f + 2 - static_cast<double>(k));
        if (interpolation != Interpolation::lanczos3) return w;
        double sum = 0, mean = 0;
        for (const double weight : w) sum += weight;
        for (std::size_t k = 0; k < 6; ++k) mean += w[k] / sum * static_cast<double>(k);
        for (double& weight : w) weight /= sum;
        w[2] += mean - (2 + f);
        w[3] -= mean - (2 + f);
        return w;
    }

    static double kernel(Interpolation interpolation, double t) {
        t = std::abs(t);
        if (interpolation == Interpolation::bilinear) return std::max(0.0, 1 - t);
        if (interpolation == Interpolation::lanczos3) {
            if (t == 0 || t >= 3) return t == 0 ? 1 : 0;
            return 3 * std::sin(M_PI * t) * std::sin(M_PI * t / 3) / (M_PI * M_PI * t * t);
        }
        if (t < 1) return 1.5 * t * t * t - 2.5 * t * t + 1;
        return t < 2 ? -0.5 * t * t * t + 2.5 * t * t - 4 * t + 2 : 0;
    }

    double fade(double position, double size) const {
        const double outside = std::max({0.0, -position, position - size});
        if (!image_.has_alpha()) return 1;
        return options_.interpolation == Interpolation::nearest ? (outside > 0 ? 0 : 1)
                                                                : std::clamp(1 - 2 * outside, 0.0, 1.0);
    }

    // Before anything is clamped; [4] says how much of it is inside the picture.
    Premultiplied sample(const Eigen::Vector2d& p) const {
        Premultiplied sum{};
        if (options_.interpolation == Interpolation::nearest) {
            sum = pixel(static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y())));
        } else {
            const int x = static_cast<int>(std::floor(p.x() - 0.5)), y = static_cast<int>(std::floor(p.y() - 0.5));
            const Weights wx = weights(options_.interpolation, p.x() - 0.5 - x);
            const Weights wy = weights(options_.interpolation, p.y() - 0.5 - y);
            for (std::size_t j = 0; j < 6; ++j) {
                for (std::size_t i = 0; i < 6; ++i) {
                    const Premultiplied tap = pixel(x - 2 + static_cast<int>(i), y - 2 + static_cast<int>(j));
                    for (std::size_t c = 0; c < 4; ++c) sum[c] += wx[i] * wy[j] * tap[c];
                }
            }
        }
        sum[4] = fade(p.x(), image_.width()) * fade(p.y(), image_.height());
        return sum;
    }

    // A filter that overshoots must not leave the range of the picture: whole numbers cannot, and alpha must not.
    Premultiplied within_range(Premultiplied sum, double faded) const {
        sum[4] = 0;
        if (sum[3] <= 0) return {};
        const double alpha = std::min(sum[3], 1.0);
        for (std::size_t c = 0; c < 3; ++c) {
            double straight = sum[c] / sum[3];
            if (image_.pixels.depth() != CV_32F) straight = std::clamp(straight, 0.0, image_.full_value());
            sum[c] = straight * alpha * faded;
        }
        sum[3] = alpha * faded;
        return sum;
    }

    const Image& image_;
    const TriangleMesh& rest_;
    const Eigen::MatrixX2d& moved_;
    WarpOptions options_;
    std::vector<std::pair<int, int>> border_;
    std::set<std::pair<double, Eigen::Index>> order_;  // by depth, then by index
};

}  // namespace puppetwarp::testing
