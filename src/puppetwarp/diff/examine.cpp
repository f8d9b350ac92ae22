#include <puppetwarp/diff/examine.h>

#include <puppetwarp/diff/alignment.h>
#include <puppetwarp/diff/antialiasing.h>
#include <puppetwarp/diff/dense_window.h>
#include <puppetwarp/diff/flip.h>
#include <puppetwarp/diff/metadata_difference.h>
#include <puppetwarp/diff/row_reader.h>
#include <puppetwarp/diff/selection.h>
#include <puppetwarp/diff/ssim.h>
#include <puppetwarp/diff/verdict.h>

#include <puppetwarp/base/errors.h>

#include <opencv2/core.hpp>

#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

namespace puppetwarp {

namespace {

std::string channels_phrase(const Image& image) {
    static constexpr std::array<const char*, 4> kPhrases{"grey", "grey with alpha", "RGB", "RGB with alpha"};
    const int channels = image.pixels.channels();
    assert(channels >= 1 && channels <= 4);
    return kPhrases[static_cast<std::size_t>(channels - 1)];
}

// The parts that fit, what of them is compared, and by which move.
void align(const Image& expected, const Image& actual, const CompareOptions& options, Examination& result) {
    cv::Mat selected = selected_pixels(options, expected.pixels.size());
    if (!selected.empty() && cv::countNonZero(selected) == 0) {
        throw InvalidInput("mask and ignore", "leave nothing to compare");
    }
    Shift shift;
    if (options.shift_px > 0) {
        shift = best_shift(expected.pixels, actual.pixels, selected, options.alpha, options.shift_px);
    }
    result.part = overlap(expected.pixels.size(), shift);
    if (!selected.empty()) selected = selected(result.part);
    result.pair = {expected.pixels(result.part), actual.pixels(result.part + cv::Point(shift.x, shift.y)), selected,
                   selected.empty() ? std::int64_t{result.part.width} * result.part.height
                                    : std::int64_t{cv::countNonZero(selected)},
                   options.alpha};
    result.comparison.compared_pixels = result.pair.selected_pixels;
    result.comparison.shift_x = shift.x;
    result.comparison.shift_y = shift.y;
}

template <class Sample>
std::vector<double> values_as(const cv::Mat& pixels, int x, int y, double full) {
    const auto* sample = reinterpret_cast<const Sample*>(pixels.ptr(y, x));
    std::vector<double> values;
    values.reserve(static_cast<std::size_t>(pixels.channels()));
    for (int c = 0; c < pixels.channels(); ++c) values.push_back(sample[c] / full);
    return values;
}

std::vector<double> values_at(const cv::Mat& pixels, int x, int y) {
    switch (pixels.depth()) {
        case CV_8U: return values_as<std::uint8_t>(pixels, x, y, 255);
        case CV_16U: return values_as<std::uint16_t>(pixels, x, y, 65535);
        default: return values_as<float>(pixels, x, y, 1);
    }
}

void fill_channel_figures(const ChannelFigures& figures, Examination& result) {
    Comparison& comparison = result.comparison;
    comparison.max = figures.max;
    comparison.mean = figures.mean;
    comparison.rmse = std::sqrt(figures.mean_square);
    comparison.psnr = comparison.rmse > 0 ? -20 * std::log10(comparison.rmse) : std::numeric_limits<double>::infinity();
    if (figures.max_x < 0) return;
    comparison.max_x = result.part.x + figures.max_x;
    comparison.max_y = result.part.y + figures.max_y;
    comparison.max_channel = figures.max_channel;
    comparison.expected_at_max = values_at(result.pair.expected, figures.max_x, figures.max_y);
    comparison.actual_at_max = values_at(result.pair.actual, figures.max_x, figures.max_y);
}

void fill_flip(const CompareOptions& options, bool keep_errors, Examination& result) {
    Comparison& comparison = result.comparison;
    if (keep_errors) result.errors = cv::Mat::zeros(result.part.size(), CV_32F);
    const FlipFigures figures = flip(result.pair, options.pixels_per_degree, comparison.threshold, result.marks,
                                     keep_errors ? &result.errors : nullptr);
    comparison.flip = figures.mean;
    comparison.flip_max = figures.max;
    if (figures.max_x < 0) return;
    comparison.flip_max_x = result.part.x + figures.max_x;
    comparison.flip_max_y = result.part.y + figures.max_y;
}

void fill_differing(Examination& result) {
    Comparison& comparison = result.comparison;
    const MarkedArea area = marked_area(result.marks, kOver);
    comparison.differing_pixels = area.pixels;
    comparison.differing_percent =
        100 * static_cast<double>(area.pixels) / static_cast<double>(comparison.compared_pixels);
    if (area.pixels == 0) return;
    comparison.box_x = result.part.x + area.box.x;
    comparison.box_y = result.part.y + area.box.y;
    comparison.box_width = area.box.width;
    comparison.box_height = area.box.height;
}

void fill_window(int side_px, Examination& result) {
    result.shown_marks |= kSlight;
    const DenseWindow window = densest_window(result.marks, kSlight, side_px);
    result.comparison.window_pixels = window.pixels;
    result.comparison.window_x = result.part.x + window.x;
    result.comparison.window_y = result.part.y + window.y;
}

// What a pixel's channels may differ by before the pixel counts as differing; where another figure decides, nothing.
double pixel_threshold(const CompareOptions& options) {
    switch (deciding_metric(options)) {
        case DiffMetric::max: return metric_limit(options);
        case DiffMetric::flip: return -1;  // marked by another rule
        default: return 0;
    }
}

}  // namespace

Incomparable why_incomparable(const Image& expected, const Image& actual, AlphaRule alpha) {
    std::ostringstream reason;
    if (expected.pixels.size() != actual.pixels.size()) {
        reason << "the sizes differ: expected " << expected.width() << " x " << expected.height() << ", actual "
               << actual.width() << " x " << actual.height();
        return {"size", reason.str()};
    }
    if (compared_channels(expected.pixels, alpha) != compared_channels(actual.pixels, alpha)) {
        reason << "the channels differ: expected " << channels_phrase(expected) << ", actual "
               << channels_phrase(actual);
        return {"channels", reason.str()};
    }
    return {};
}

Examination examine(const Image& expected, const Image& actual, const CompareOptions& options, bool keep_errors) {
    require_sound(options);
    Examination result;
    Comparison& comparison = result.comparison;
    comparison.width = expected.width();
    comparison.height = expected.height();
    comparison.metric = deciding_metric(options);
    comparison.threshold = metric_limit(options);
    if (options.metadata) comparison.metadata = metadata_differences(expected.metadata, actual.metadata);

    const Incomparable incomparable = why_incomparable(expected, actual, options.alpha);
    comparison.comparable = incomparable.rule.empty();
    if (comparison.comparable) {
        align(expected, actual, options, result);
        result.marks = cv::Mat::zeros(result.part.size(), CV_8U);
        fill_channel_figures(measure(result.pair, options.window_threshold, pixel_threshold(options), result.marks),
                             result);
        if (comparison.metric == DiffMetric::flip) fill_flip(options, keep_errors, result);
        if (comparison.metric == DiffMetric::ssim || options.min_ssim) comparison.ssim = ssim(result.pair);
        if (options.antialiasing) comparison.antialiased_pixels = tolerate_antialiased(result.pair, result.marks);
        fill_differing(result);
        if (options.window_px > 0) fill_window(options.window_px, result);
    }
    judge(incomparable, options, comparison);
    return result;
}

}  // namespace puppetwarp
