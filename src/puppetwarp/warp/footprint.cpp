#include <puppetwarp/warp/footprint.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace puppetwarp::detail {

namespace {

constexpr int most_a_row = 8;
constexpr double farthest_step = 1 << 14;

struct Comb {
    int samples = 1;
    double distance_px = 0;
};

// Times 12, as is every variance here: that of an interval of length 1.
double filter_variance(Interpolation interpolation) {
    return interpolation == Interpolation::bilinear ? 2 : 0;
}

double spared_variance(Interpolation interpolation) {
    return interpolation == Interpolation::bilinear ? 1.7 : interpolation == Interpolation::bicubic ? 0.4 : 0;
}

double added_variance(double a, Interpolation interpolation) {
    const double less = spared_variance(interpolation);
    if (a >= 2) return a * a - less;
    constexpr double limit = single_sample_limit * single_sample_limit;
    return std::max(0.0, (a * a - limit) / (4 - limit)) * (4 - less);
}

// Samples along one axis, of a step of `a` source pixels, on a level.
Comb comb(double a, Interpolation interpolation, int level) {
    const double size = std::ldexp(1, level);
    const double filter = filter_variance(interpolation), area = size * size;
    const double variance = added_variance(a, interpolation) + filter - filter * area - (area - 1);
    Comb result;
    if (!(variance > 0)) return result;
    result.samples = static_cast<int>(std::ceil(std::clamp(a / size, 1.0, 2.0 * most_samples) - 1e-9));
    if (result.samples == 1) return result;
    result.distance_px = std::sqrt(variance / (result.samples * result.samples - 1)) / a;
    return result;
}

}  // namespace

Footprint footprint(const Eigen::Matrix2d& jacobian, Interpolation interpolation, int top_level) {
    constexpr double limit = single_sample_limit * single_sample_limit;
    const double a2 = jacobian.col(0).squaredNorm(), b2 = jacobian.col(1).squaredNorm();
    if (interpolation == Interpolation::nearest || !(a2 > limit || b2 > limit)) return {};
    if (!(a2 + b2 < farthest_step * farthest_step)) return {};
    const double a = std::sqrt(a2), b = std::sqrt(b2);
    Footprint result;
    for (int level = 0; level <= top_level; ++level) {
        const Comb x = comb(a, interpolation, level), y = comb(b, interpolation, level);
        result = {level, x.samples, y.samples, x.distance_px, y.distance_px};
        if (result.samples() <= most_samples) return result;
    }
    // Shrunk to less than a pixel of the highest level: what lies between the samples hardly matters.
    for (auto [samples, distance] : {std::pair{&result.nx, &result.dx_px}, {&result.ny, &result.dy_px}}) {
        if (*samples <= most_a_row) continue;
        *samples = most_a_row;
        *distance = 1.0 / most_a_row;
    }
    return result;
}

}  // namespace puppetwarp::detail
