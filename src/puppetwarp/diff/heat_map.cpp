#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/diff/compare.h>
#include <puppetwarp/diff/row_difference.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

constexpr int kBandRows = 32;
constexpr int kSidesAHalo = 400;  // the longer side over this is how far a halo reaches
const cv::Vec3b kHalo(214, 170, 255);

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

// Yellow, red, black at 0, 1/4 and 1. The root spreads out the small differences, which are the common ones.
cv::Vec3b heat_colour(double difference) {
    const double heat = std::sqrt(std::min(difference, 1.0));
    return heat < 0.5 ? cv::Vec3b(255, level(0.85 * (1 - 2 * heat)), 0) : cv::Vec3b(level(2 - 2 * heat), 0, 0);
}

// Draws what differs in some rows over the map, and marks it in `differing` (1 a pixel, else 0).
template <class Difference>
void draw_heat(const Image& expected, const Image& actual, double threshold, int first, int last, cv::Mat& map,
               cv::Mat& differing) {
    const int channels = expected.pixels.channels();
    const Difference allowed = largest_allowed<Difference>(threshold);
    RowDifference<Difference> differences(expected, actual);
    for (int y = first; y < last; ++y) {
        const Difference* pixel = differences.row(y);
        if (!pixel) continue;
        for (int x = 0; x < expected.width(); ++x, pixel += channels) {
            const Difference difference = *std::max_element(pixel, pixel + channels);
            if (difference <= allowed) continue;
            map.at<cv::Vec3b>(y, x) = heat_colour(difference / full_difference<Difference>);
            differing.at<std::uint8_t>(y, x) = 1;
        }
    }
}

void draw_halo(const cv::Mat& differing, cv::Mat& map) {
    const int reach = std::max(map.cols, map.rows) / kSidesAHalo;
    if (reach == 0) return;
    cv::Mat near;
    cv::dilate(differing, near, cv::getStructuringElement(cv::MORPH_RECT, {2 * reach + 1, 2 * reach + 1}));
    map.setTo(cv::Scalar(kHalo[0], kHalo[1], kHalo[2]), near - differing);
}

}  // namespace

Image heat_map(const Image& expected, const Image& actual, const CompareOptions& options) {
    require_sound(options);
    const std::string incomparable = incomparable_reason(expected, actual);
    if (!incomparable.empty()) {
        throw InvalidInput("heat map", incomparable, "compare pictures of one size and one kind");
    }
    const bool integers = have_integers(expected, actual);
    cv::Mat map(expected.pixels.size(), CV_8UC3);
    cv::Mat differing = cv::Mat::zeros(expected.pixels.size(), CV_8U);
    parallel_for(0, expected.height(), kBandRows, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            switch (expected.pixels.depth()) {
                case CV_8U: draw_pale_grey<std::uint8_t>(expected, y, map); break;
                case CV_16U: draw_pale_grey<std::uint16_t>(expected, y, map); break;
                default: draw_pale_grey<float>(expected, y, map);
            }
        }
        const auto draw = integers ? draw_heat<std::uint16_t> : draw_heat<double>;
        draw(expected, actual, options.threshold, first, last, map, differing);
    });
    draw_halo(differing, map);
    Image result;
    result.pixels = map;
    return result;
}

}  // namespace puppetwarp
