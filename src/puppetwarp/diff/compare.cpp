#include <puppetwarp/base/threads.h>
#include <puppetwarp/diff/compare.h>
#include <puppetwarp/diff/row_difference.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <type_traits>
#include <vector>

namespace puppetwarp {

namespace {

// Rows a task. The bands, and so the order in which floating sums are added, depend on nothing else.
constexpr int kBandRows = 32;

// What is known of some rows; joined from top to bottom. Integer sums are exact: 2^32 a squared difference leaves room
// for 2^32 samples.
template <class Difference>
struct Figures {
    using Sum = std::conditional_t<std::is_integral_v<Difference>, std::uint64_t, double>;

    Sum sum = 0;
    Sum sum_of_squares = 0;
    Difference max = 0;
    int max_x = -1, max_y = -1;
    std::int64_t differing = 0;
    int left = std::numeric_limits<int>::max(), right = -1;  // of the differing pixels, both inclusive
    int top = std::numeric_limits<int>::max(), bottom = -1;

    void join(const Figures& below) {
        sum += below.sum;
        sum_of_squares += below.sum_of_squares;
        if (below.max > max) {
            max = below.max;
            max_x = below.max_x;
            max_y = below.max_y;
        }
        differing += below.differing;
        left = std::min(left, below.left);
        right = std::max(right, below.right);
        top = std::min(top, below.top);
        bottom = std::max(bottom, below.bottom);
    }
};

template <class Difference>
void count_differing(const Difference* row, int y, int width, int channels, Difference allowed,
                     Figures<Difference>& figures) {
    for (int x = 0; x < width; ++x, row += channels) {
        if (*std::max_element(row, row + channels) <= allowed) continue;
        ++figures.differing;
        figures.left = std::min(figures.left, x);
        figures.right = std::max(figures.right, x);
        figures.top = std::min(figures.top, y);
        figures.bottom = y;
    }
}

template <class Difference>
void add_row(const Difference* row, int y, int width, int channels, Difference allowed, Figures<Difference>& figures) {
    using Sum = typename Figures<Difference>::Sum;
    const std::ptrdiff_t samples = static_cast<std::ptrdiff_t>(width) * channels;
    Sum sum = 0, sum_of_squares = 0;
    Difference max = 0;
    for (std::ptrdiff_t i = 0; i < samples; ++i) {
        const Sum difference = row[i];
        sum += difference;
        sum_of_squares += difference * difference;
        max = std::max(max, row[i]);
    }
    figures.sum += sum;
    figures.sum_of_squares += sum_of_squares;
    if (max > figures.max) {
        figures.max = max;
        figures.max_x = static_cast<int>((std::find(row, row + samples, max) - row) / channels);
        figures.max_y = y;
    }
    if (max > allowed) count_differing(row, y, width, channels, allowed, figures);
}

template <class Difference>
Figures<Difference> measure(const Image& expected, const Image& actual, double threshold) {
    const int height = expected.height();
    const Difference allowed = largest_allowed<Difference>(threshold);
    std::vector<Figures<Difference>> bands(static_cast<std::size_t>((height + kBandRows - 1) / kBandRows));
    parallel_for(0, height, kBandRows, [&](int first, int last) {
        RowDifference<Difference> differences(expected, actual);
        Figures<Difference> band;
        for (int y = first; y < last; ++y) {
            const Difference* row = differences.row(y);
            if (row) add_row(row, y, expected.width(), expected.pixels.channels(), allowed, band);
        }
        bands[static_cast<std::size_t>(first / kBandRows)] = band;
    });
    Figures<Difference> all;
    for (const Figures<Difference>& band : bands) all.join(band);
    return all;
}

template <class Difference>
void fill(Comparison& result, const Figures<Difference>& figures, int channels) {
    constexpr double full = full_difference<Difference>;
    const double pixels = static_cast<double>(result.width) * result.height;
    const double samples = std::max(1.0, pixels * channels);
    result.max = figures.max / full;
    result.max_x = figures.max_x;
    result.max_y = figures.max_y;
    result.mean = static_cast<double>(figures.sum) / samples / full;
    result.rmse = std::sqrt(static_cast<double>(figures.sum_of_squares) / samples) / full;
    result.psnr = result.rmse > 0 ? -20 * std::log10(result.rmse) : std::numeric_limits<double>::infinity();
    result.differing_pixels = figures.differing;
    if (figures.differing == 0) return;
    result.differing_percent = 100 * static_cast<double>(figures.differing) / pixels;
    result.box_x = figures.left;
    result.box_y = figures.top;
    result.box_width = figures.right - figures.left + 1;
    result.box_height = figures.bottom - figures.top + 1;
}

std::string difference_reason(const Comparison& comparison) {
    std::ostringstream reason;
    reason << comparison.differing_pixels << (comparison.differing_pixels == 1 ? " pixel differs" : " pixels differ")
           << " (" << comparison.differing_percent << " %), by up to " << comparison.max << " of full scale at "
           << comparison.max_x << "," << comparison.max_y;
    return reason.str();
}

}  // namespace

Comparison compare(const Image& expected, const Image& actual, const CompareOptions& options) {
    require_sound(options);
    Comparison result;
    result.width = expected.width();
    result.height = expected.height();
    result.reason = incomparable_reason(expected, actual);
    result.comparable = result.reason.empty();
    result.same = result.comparable;
    if (!result.comparable) return result;

    const int channels = expected.pixels.channels();
    if (have_integers(expected, actual)) {
        fill(result, measure<std::uint16_t>(expected, actual, options.threshold), channels);
    } else {
        fill(result, measure<double>(expected, actual, options.threshold), channels);
    }
    result.same = result.differing_pixels == 0;
    if (!result.same) result.reason = difference_reason(result);
    return result;
}

}  // namespace puppetwarp
