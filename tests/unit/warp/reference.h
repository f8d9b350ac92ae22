#pragma once

#include "scenes.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
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
        for (Eigen::Index f = 0; f < rest.F.rows(); ++f) {
            double depth = 0;
            if (options.depth.size() > 0)
                for (int k = 0; k < 3; ++k) depth += options.depth(rest.F(f, k));
            order_.emplace(depth, f);
        }
    }

    //! Premultiplied, alpha in [0, 1], colour in the picture's numbers. [4] is set where an edge passes too near for
    //! floating point to decide.
    Premultiplied at(int column, int row) const {
        const double x = options_.canvas.x + column + 0.5, y = options_.canvas.y + row + 0.5;
        Premultiplied below{};
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
            below = over(sample_triangle(to, from, p), below);
            below[4] = std::max(below[4], ambiguous);
        }
        return below;
    }

private:
    using Corners = std::array<Eigen::Vector2d, 3>;

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
        const double sigma = J.jacobiSvd().singularValues()[0];
        const bool many = options_.interpolation != Interpolation::nearest && sigma > 1.5;
        const int n = many ? static_cast<int>(std::ceil(std::min(sigma, 4.0))) : 1;
        Premultiplied mean{};
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j) {
                const Eigen::Vector2d q = p + Eigen::Vector2d((i + 0.5) / n - 0.5, (j + 0.5) / n - 0.5);
                const Premultiplied one = sample(from[0] + J * (q - to[0]));
                for (std::size_t c = 0; c < 4; ++c) mean[c] += one[c] / (n * n);
            }
        }
        return mean;
    }

    Premultiplied pixel(int x, int y) const {
        x = std::clamp(x, 0, image_.width() - 1);
        y = std::clamp(y, 0, image_.height() - 1);
        Premultiplied result{};
        const int channels = image_.pixels.channels(), colours = channels <= 2 ? 1 : 3;
        result[3] = image_.has_alpha() ? value_at(image_, x, y, channels - 1) / image_.full_value() : 1;
        for (int c = 0; c < colours; ++c) result[static_cast<std::size_t>(c)] = value_at(image_, x, y, c) * result[3];
        return result;
    }

    static double kernel(Interpolation interpolation, double t) {
        t = std::abs(t);
        if (interpolation == Interpolation::bilinear) return std::max(0.0, 1 - t);
        if (t < 1) return 1.5 * t * t * t - 2.5 * t * t + 1;
        return t < 2 ? -0.5 * t * t * t + 2.5 * t * t - 4 * t + 2 : 0;
    }

    double fade(double position, double size) const {
        const double outside = std::max({0.0, -position, position - size});
        if (!image_.has_alpha()) return 1;
        return options_.interpolation == Interpolation::nearest ? (outside > 0 ? 0 : 1)
                                                                : std::clamp(1 - 2 * outside, 0.0, 1.0);
    }

    Premultiplied sample(const Eigen::Vector2d& p) const {
        Premultiplied sum{};
        if (options_.interpolation == Interpolation::nearest) {
            sum = pixel(static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y())));
        } else {
            const int x = static_cast<int>(std::floor(p.x() - 0.5)), y = static_cast<int>(std::floor(p.y() - 0.5));
            for (int j = y - 1; j <= y + 2; ++j) {
                for (int i = x - 1; i <= x + 2; ++i) {
                    const double weight = kernel(options_.interpolation, p.x() - 0.5 - i) *
                                          kernel(options_.interpolation, p.y() - 0.5 - j);
                    for (std::size_t c = 0; c < 4; ++c) sum[c] += weight * pixel(i, j)[c];
                }
            }
        }
        return within_range(sum, fade(p.x(), image_.width()) * fade(p.y(), image_.height()));
    }

    // A filter that overshoots must not leave the range of the picture: whole numbers cannot, and alpha must not.
    Premultiplied within_range(Premultiplied sum, double faded) const {
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
    std::set<std::pair<double, Eigen::Index>> order_;  // by depth, then by index
};

}  // namespace puppetwarp::testing
