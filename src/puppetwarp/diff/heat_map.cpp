#include <puppetwarp/diff/heat_map.h>

#include <puppetwarp/base/threads.h>
#include <puppetwarp/diff/row_difference.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

constexpr int kSidesAHalo = 400;  // the longer side over this is how far a halo reaches
const cv::Vec3b kHalo(214, 170, 255);
const cv::Vec3b kTolerated(40, 150, 255);

std::uint8_t level(double unit) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(unit, 0.0, 1.0)));
}

// NaN counts as black.
double clamped(double value) {
    return value > 0 ? std::min(value, 1.0) : 0.0;
}

// The expected picture's luma over white, drawn up to 0.6-1 so that every heat colour stands out from it.
template <class Sample>
std::uint8_t pale_grey(const Sample* pixel, int channels, double full) {
    const double luma = channels < 3 ? clamped(pixel[0] / full)
                                     : 0.299 * clamped(pixel[0] / full) + 0.587 * clamped(pixel[1] / full) +
                                           0.114 * clamped(pixel[2] / full);
    const double alpha = channels % 2 == 0 ? clamped(pixel[channels - 1] / full) : 1.0;
    return level(1 - 0.4 * alpha * (1 - luma));
}

template <class Sample>
void draw_pale_grey(const Image& image, int y, cv::Mat& map) {
    const int channels = image.pixels.channels();
    const double full = image.full_value();
    const Sample* pixel = image.pixels.ptr<Sample>(y);
    auto* to = map.ptr<cv::Vec3b>(y);
    for (int x = 0; x < image.width(); ++x, pixel += channels) to[x] = cv::Vec3b::all(pale_grey(pixel, channels, full));
}

void draw_pale_picture(const Image& image, cv::Mat& map) {
    parallel_for(0, image.height(), kBandRows, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            switch (image.pixels.depth()) {
                case CV_8U: draw_pale_grey<std::uint8_t>(image, y, map); break;
                case CV_16U: draw_pale_grey<std::uint16_t>(image, y, map); break;
                default: draw_pale_grey<float>(image, y, map);
            }
        }
    });
}

// Yellow, red, black at 0, 1/4 and 1. The root spreads out the small differences, which are the common ones.
cv::Vec3b heat_colour(double difference) {
    const double heat = std::sqrt(std::min(difference, 1.0));
    return heat < 0.5 ? cv::Vec3b(255, level(0.85 * (1 - 2 * heat)), 0) : cv::Vec3b(level(2 - 2 * heat), 0, 0);
}

// Largest differences of the channels of one row, on a scale of 0 to 1.
template <class Difference>
void row_heat(RowDifference<Difference>& differences, int y, std::vector<double>& heat) {
    const Difference* pixel = differences.row(y, nullptr);
    for (double& value : heat) {
        value = pixel ? *std::max_element(pixel, pixel + differences.channels()) / full_difference<Difference> : 0;
        if (pixel) pixel += differences.channels();
    }
}

// Colours what is marked. `shown` are the marks that get their heat.
template <class Difference>
void draw_heat(const Examination& examination, std::uint8_t shown, int first, int last, cv::Mat& map) {
    const AlignedPair& pair = examination.pair;
    RowDifference<Difference> differences(pair.expected, pair.actual, pair.alpha);
    std::vector<double> heat(static_cast<std::size_t>(pair.expected.cols));
    for (int y = first; y < last; ++y) {
        const std::uint8_t* marks = examination.marks.ptr(y);
        if (std::all_of(marks, marks + pair.expected.cols, [](std::uint8_t mark) { return mark == 0; })) continue;
        if (examination.errors.empty()) {
            row_heat(differences, y, heat);
        } else {
            const float* errors = examination.errors.ptr<float>(y);
            std::copy(errors, errors + pair.expected.cols, heat.begin());
        }
        auto* to = map.ptr<cv::Vec3b>(y);
        for (int x = 0; x < pair.expected.cols; ++x) {
            if (marks[x] & kAntialiased) to[x] = kTolerated;
            if (marks[x] & shown) to[x] = heat_colour(heat[static_cast<std::size_t>(x)]);
        }
    }
}

// A blue tint, which the pale picture shows through.
void tint(const cv::Mat& where, cv::Mat& map) {
    for (int y = 0; y < map.rows; ++y) {
        auto* to = map.ptr<cv::Vec3b>(y);
        for (int x = 0; x < map.cols; ++x) {
            if (!where.at<std::uint8_t>(y, x)) continue;
            to[x] = {level(to[x][0] / 255.0 - 0.25), level(to[x][1] / 255.0 - 0.12), to[x][2]};
        }
    }
}

void tint_what_is_not_compared(const Examination& examination, cv::Mat& map) {
    const AlignedPair& pair = examination.pair;
    if (pair.selected.empty() && examination.part.size() == map.size()) return;
    cv::Mat left_out(map.size(), CV_8U, cv::Scalar(1));
    cv::Mat compared = left_out(examination.part);
    if (pair.selected.empty()) {
        compared.setTo(0);
    } else {
        compared.setTo(0, pair.selected);
    }
    tint(left_out, map);
}

// \param coloured  what keeps its colour.
void draw_halo(const cv::Mat& differing, const cv::Mat& coloured, cv::Mat& map) {
    const int reach = std::max(map.cols, map.rows) / kSidesAHalo;
    if (reach == 0) return;
    cv::Mat near;
    cv::dilate(differing, near, cv::getStructuringElement(cv::MORPH_RECT, {2 * reach + 1, 2 * reach + 1}));
    map.setTo(cv::Scalar(kHalo[0], kHalo[1], kHalo[2]), near & ~coloured);
}

}  // namespace

Image heat_map_of(const Image& expected, const Examination& examination) {
    const AlignedPair& pair = examination.pair;
    cv::Mat map(expected.pixels.size(), CV_8UC3);
    draw_pale_picture(expected, map);
    tint_what_is_not_compared(examination, map);

    cv::Mat part = map(examination.part);
    const std::uint8_t shown = examination.shown_marks;
    with_difference_of(pair.expected, pair.actual, pair.alpha, [&](auto zero) {
        parallel_for(0, part.rows, kBandRows,
                     [&](int first, int last) { draw_heat<decltype(zero)>(examination, shown, first, last, part); });
    });
    cv::Mat differing = cv::Mat::zeros(map.size(), CV_8U), coloured = differing.clone();
    differing(examination.part).setTo(255, (examination.marks & shown) != 0);
    coloured(examination.part).setTo(255, (examination.marks & (shown | kAntialiased)) != 0);
    draw_halo(differing, coloured, map);
    Image result;
    result.pixels = map;
    return result;
}

}  // namespace puppetwarp
