#include <puppetwarp/diff/flip_filters.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace puppetwarp {

namespace {

// Table 1 of the paper: a sqrt(pi / b) exp(-pi^2 r^2 / b), r in degrees.
struct Sensitivity {
    double a, b;
};
constexpr Sensitivity kAchromatic{1, 0.0047}, kRedGreen{1, 0.0053}, kBlueYellow[2]{{34.1, 0.04}, {13.5, 0.025}};
constexpr double kFeatureWidth_deg = 0.082;  // peak to trough of the human edge detector, two standard deviations
constexpr double kDeviations = 3;            // how far filters reach
// Gaussians narrower than the widest end earlier: what they would add is below the last digit of a float.
constexpr double kFarDeviations = 6;

double sum_of(const std::vector<double>& weight) {
    double sum = weight[0];
    for (std::size_t i = 1; i < weight.size(); ++i) sum += 2 * weight[i];
    return sum;
}

FilterSide as_side(const std::vector<double>& weight, double scale, bool odd) {
    FilterSide side;
    side.odd = odd;
    for (const double each : weight) side.weight.push_back(static_cast<float>(each * scale));
    return side;
}

std::vector<double> sampled(int reach, const std::function<double(double)>& function) {
    std::vector<double> weight;
    for (int i = 0; i <= reach; ++i) weight.push_back(function(i));
    return weight;
}

std::vector<double> sensitivity_weights(const Sensitivity& term, double pixels_per_degree, int reach) {
    constexpr double pi2 = std::numbers::pi * std::numbers::pi;
    const double deviation_px = std::sqrt(term.b / (2 * pi2)) * pixels_per_degree;
    const int far = std::min(reach, static_cast<int>(std::ceil(kFarDeviations * deviation_px)));
    return sampled(far, [&](double px) {
        const double degrees = px / pixels_per_degree;
        return std::exp(-pi2 * degrees * degrees / term.b);
    });
}

FilterSide sensitivity(const Sensitivity& term, double pixels_per_degree, int reach) {
    const std::vector<double> weight = sensitivity_weights(term, pixels_per_degree, reach);
    return as_side(weight, 1 / sum_of(weight), false);
}

// On one side all weights are positive, on the other they are the same and negative: each side sums to 1 or -1.
FilterSide first_derivative(const std::vector<double>& weight) {
    return as_side(weight, 2 / (sum_of(weight) - weight[0]), true);
}

// Positive and negative weights are scaled apart: sampled and cut off, they are not in balance.
FilterSide second_derivative(std::vector<double> weight) {
    double positive = 0, negative = 0;
    for (std::size_t i = 0; i < weight.size(); ++i) {
        const double both_sides = (i == 0 ? 1 : 2) * weight[i];
        (both_sides > 0 ? positive : negative) += std::abs(both_sides);
    }
    for (double& each : weight) each /= each > 0 ? positive : negative;
    return as_side(weight, 1, false);
}

}  // namespace

FlipFilters::FlipFilters(double pixels_per_degree) {
    constexpr double pi2 = std::numbers::pi * std::numbers::pi;
    const int sensitivity_reach =
        static_cast<int>(std::ceil(kDeviations * std::sqrt(kBlueYellow[0].b / (2 * pi2)) * pixels_per_degree));
    achromatic = sensitivity(kAchromatic, pixels_per_degree, sensitivity_reach);
    red_green = sensitivity(kRedGreen, pixels_per_degree, sensitivity_reach);
    double volume[2];
    for (int i = 0; i < 2; ++i) {
        const double sum = sum_of(sensitivity_weights(kBlueYellow[i], pixels_per_degree, sensitivity_reach));
        volume[i] = kBlueYellow[i].a * std::sqrt(std::numbers::pi / kBlueYellow[i].b) * sum * sum;
        blue_yellow[i] = sensitivity(kBlueYellow[i], pixels_per_degree, sensitivity_reach);
    }
    for (int i = 0; i < 2; ++i) blue_yellow_share[i] = static_cast<float>(volume[i] / (volume[0] + volume[1]));

    const double deviation_px = 0.5 * kFeatureWidth_deg * pixels_per_degree;
    const int feature_reach = static_cast<int>(std::ceil(kDeviations * deviation_px));
    const auto bell = [&](double px) { return std::exp(-px * px / (2 * deviation_px * deviation_px)); };
    const std::vector<double> bells = sampled(feature_reach, bell);
    gauss = as_side(bells, 1 / sum_of(bells), false);
    edge = first_derivative(sampled(feature_reach, [&](double px) { return px * bell(px); }));
    point = second_derivative(
        sampled(feature_reach, [&](double px) { return (px * px / (deviation_px * deviation_px) - 1) * bell(px); }));
    reach = std::max(sensitivity_reach, feature_reach);
}

void Plane::resize(int new_width, int new_height) {
    width = new_width;
    height = new_height;
    values.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
}

void filter_down(const Plane& from, int margin, const FilterSide& side, Plane& to) {
    to.resize(from.width, from.height - 2 * margin);
    const float sign = side.odd ? -1.0F : 1.0F;
    for (int y = 0; y < to.height; ++y) {
        float* result = to.row(y);
        const float* middle = from.row(y + margin);
        for (int x = 0; x < to.width; ++x) result[x] = side.weight[0] * middle[x];
        for (int i = 1; i <= side.reach(); ++i) {
            const float* above = from.row(y + margin - i);
            const float* below = from.row(y + margin + i);
            const float weight = side.weight[static_cast<std::size_t>(i)];
            for (int x = 0; x < to.width; ++x) result[x] += weight * (below[x] + sign * above[x]);
        }
    }
}

void filter_across(const Plane& from, int margin, const FilterSide& side, Plane& to) {
    to.resize(from.width - 2 * margin, from.height);
    const float sign = side.odd ? -1.0F : 1.0F;
    for (int y = 0; y < to.height; ++y) {
        float* result = to.row(y);
        const float* middle = from.row(y) + margin;
        for (int x = 0; x < to.width; ++x) result[x] = side.weight[0] * middle[x];
        for (int i = 1; i <= side.reach(); ++i) {
            const float weight = side.weight[static_cast<std::size_t>(i)];
            for (int x = 0; x < to.width; ++x) result[x] += weight * (middle[x + i] + sign * middle[x - i]);
        }
    }
}

void filter(const Plane& from, int margin, const FilterSide& along_y, const FilterSide& along_x, Plane& scratch,
            Plane& to) {
    filter_down(from, margin, along_y, scratch);
    filter_across(scratch, margin, along_x, to);
}

}  // namespace puppetwarp
