#include <puppetwarp/diff/measure.h>

#include <puppetwarp/base/threads.h>
#include <puppetwarp/diff/row_difference.h>

#include <algorithm>
#include <limits>
#include <type_traits>
#include <vector>

namespace puppetwarp {

namespace {

// What is known of some rows; joined from top to bottom. Integer sums are exact: 2^32 a squared difference leaves room
// for 2^32 samples.
template <class Difference>
struct Figures {
    using Sum = std::conditional_t<std::is_integral_v<Difference>, std::uint64_t, double>;

    Sum sum = 0;
    Sum sum_of_squares = 0;
    Difference max = 0;
    int max_x = -1, max_y = -1, max_channel = -1;

    void join(const Figures& below) {
        sum += below.sum;
        sum_of_squares += below.sum_of_squares;
        if (below.max <= max) return;
        max = below.max;
        max_x = below.max_x;
        max_y = below.max_y;
        max_channel = below.max_channel;
    }
};

// So many squares of bytes fit into 32 bits, which are added faster.
constexpr std::ptrdiff_t kRun = 1 << 15;

template <class Difference>
Figures<Difference> figures_of_row(const Difference* row, int y, int width, int channels) {
    using Sum = typename Figures<Difference>::Sum;
    using RunSum = std::conditional_t<std::is_same_v<Difference, std::uint8_t>, std::uint32_t, Sum>;
    const std::ptrdiff_t samples = static_cast<std::ptrdiff_t>(width) * channels;
    Figures<Difference> figures;
    for (std::ptrdiff_t first = 0; first < samples; first += kRun) {
        const std::ptrdiff_t last = std::min(samples, first + kRun);
        RunSum sum = 0, sum_of_squares = 0;
        Difference max = 0;
        for (std::ptrdiff_t i = first; i < last; ++i) {
            const RunSum difference = row[i];
            sum += difference;
            sum_of_squares += difference * difference;
            max = std::max(max, row[i]);
        }
        figures.sum += sum;
        figures.sum_of_squares += sum_of_squares;
        figures.max = std::max(figures.max, max);
    }
    if (figures.max == 0) return figures;
    const std::ptrdiff_t at = std::find(row, row + samples, figures.max) - row;
    figures.max_x = static_cast<int>(at / channels);
    figures.max_y = y;
    figures.max_channel = static_cast<int>(at % channels);
    return figures;
}

template <class Difference>
struct Limits {
    Difference slight;
    Difference over;
    bool has_over;

    std::uint8_t mark(Difference difference) const {
        return static_cast<std::uint8_t>((difference > slight ? kSlight : 0) |
                                         (has_over && difference > over ? kOver : 0));
    }
};

template <class Difference>
void mark_row(const Difference* row, int width, int channels, const Limits<Difference>& limits, std::uint8_t* marks) {
    for (int x = 0; x < width; ++x, row += channels) marks[x] = limits.mark(*std::max_element(row, row + channels));
}

template <class Difference>
ChannelFigures measure_as(const AlignedPair& pair, double slight_threshold, double over_threshold, cv::Mat& marks) {
    const int width = pair.expected.cols, height = pair.expected.rows;
    const Limits<Difference> limits{largest_allowed<Difference>(slight_threshold),
                                    largest_allowed<Difference>(std::max(0.0, over_threshold)), over_threshold >= 0};
    std::vector<Figures<Difference>> bands(static_cast<std::size_t>((height + kBandRows - 1) / kBandRows));
    parallel_for(0, height, kBandRows, [&](int first, int last) {
        RowDifference<Difference> differences(pair.expected, pair.actual, pair.alpha);
        Figures<Difference> band;
        for (int y = first; y < last; ++y) {
            const Difference* row = differences.row(y, pair.selected_row(y));
            if (!row) continue;
            const Figures<Difference> figures = figures_of_row(row, y, width, differences.channels());
            if (limits.mark(figures.max)) mark_row(row, width, differences.channels(), limits, marks.ptr(y));
            band.join(figures);
        }
        bands[static_cast<std::size_t>(first / kBandRows)] = band;
    });
    Figures<Difference> all;
    for (const Figures<Difference>& band : bands) all.join(band);

    constexpr double full = full_difference<Difference>;
    const double samples = static_cast<double>(pair.selected_pixels) * compared_channels(pair.expected, pair.alpha);
    return {all.max / full,
            all.max_x,
            all.max_y,
            all.max_channel,
            static_cast<double>(all.sum) / samples / full,
            static_cast<double>(all.sum_of_squares) / samples / (full * full)};
}

}  // namespace

ChannelFigures measure(const AlignedPair& pair, double slight_threshold, double over_threshold, cv::Mat& marks) {
    return with_difference_of(pair.expected, pair.actual, pair.alpha, [&](auto zero) {
        return measure_as<decltype(zero)>(pair, slight_threshold, over_threshold, marks);
    });
}

MarkedArea marked_area(const cv::Mat& marks, std::uint8_t mark) {
    MarkedArea area;
    int left = std::numeric_limits<int>::max(), right = -1;
    for (int y = 0; y < marks.rows; ++y) {
        const std::uint8_t* row = marks.ptr(y);
        int pixels = 0;
        for (int x = 0; x < marks.cols; ++x) pixels += (row[x] & mark) != 0;
        if (pixels == 0) continue;
        const auto marked = [mark](std::uint8_t bits) { return (bits & mark) != 0; };
        left = std::min(left, static_cast<int>(std::find_if(row, row + marks.cols, marked) - row));
        int last = marks.cols - 1;
        while (!marked(row[last])) --last;
        right = std::max(right, last);
        if (area.pixels == 0) area.box.y = y;
        area.box.height = y + 1 - area.box.y;
        area.pixels += pixels;
    }
    if (area.pixels == 0) return area;
    area.box.x = left;
    area.box.width = right + 1 - left;
    return area;
}

}  // namespace puppetwarp
