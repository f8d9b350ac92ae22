#include <puppetwarp/diff/antialiasing.h>

#include <puppetwarp/base/threads.h>
#include <puppetwarp/diff/row_reader.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <type_traits>
#include <vector>

namespace puppetwarp {

namespace {

constexpr int kFewEqual = 2;  // neighbours as bright as the pixel itself, at most
constexpr int kFlat = 3;      // neighbours of the same colour, at least

// Single pixels of a picture.
template <class Sample>
class PixelView {
public:
    PixelView(const cv::Mat& pixels, AlphaRule alpha)
        : pixels_(pixels),
          channels_(pixels.channels()),
          compared_(compared_channels(pixels, alpha)),
          blends_(channels_ % 2 == 0 && alpha != AlphaRule::ignore) {}

    int width() const { return pixels_.cols; }
    int height() const { return pixels_.rows; }

    // Luma over white, up to a factor and an offset that are the same for all pixels. Of integers it is exact, so that
    // equal colours are equally bright to the bit.
    double brightness(int x, int y) const {
        const Sample* sample = at(x, y);
        const double luma =
            channels_ < 3 ? 1000.0 * sample[0] : 299.0 * sample[0] + 587.0 * sample[1] + 114.0 * sample[2];
        return blends_ ? (luma - 1000.0 * kFull) * sample[channels_ - 1] : luma;
    }

    bool equal(int x, int y, int other_x, int other_y) const {
        return std::equal(at(x, y), at(x, y) + compared_, at(other_x, other_y));
    }

private:
    static constexpr double kFull = std::is_integral_v<Sample> ? std::numeric_limits<Sample>::max() : 1;

    const Sample* at(int x, int y) const { return pixels_.ptr<Sample>(y) + static_cast<std::ptrdiff_t>(x) * channels_; }

    const cv::Mat& pixels_;
    int channels_;
    int compared_;
    bool blends_;
};

template <class View>
bool is_at_border(const View& view, int x, int y) {
    return x == 0 || y == 0 || x + 1 == view.width() || y + 1 == view.height();
}

// Calls `see(x, y)` for the up to eight neighbours of a pixel, until it returns false.
template <class View, class See>
void for_each_neighbour(const View& view, int x, int y, See&& see) {
    const int right = std::min(x + 1, view.width() - 1), bottom = std::min(y + 1, view.height() - 1);
    for (int row = std::max(y - 1, 0); row <= bottom; ++row) {
        for (int column = std::max(x - 1, 0); column <= right; ++column) {
            if ((row != y || column != x) && !see(column, row)) return;
        }
    }
}

template <class View>
bool is_flat(const View& view, int x, int y) {
    int equal = is_at_border(view, x, y) ? 1 : 0;
    for_each_neighbour(view, x, y, [&](int column, int row) {
        equal += view.equal(x, y, column, row) ? 1 : 0;
        return equal < kFlat;
    });
    return equal >= kFlat;
}

template <class View, class OtherView>
bool looks_antialiased(const View& view, const OtherView& other, int x, int y) {
    const double own = view.brightness(x, y);
    int equal = is_at_border(view, x, y) ? 1 : 0;
    double darkest = 0, brightest = 0;  // against the pixel itself
    int dark_x = x, dark_y = y, bright_x = x, bright_y = y;
    for_each_neighbour(view, x, y, [&](int column, int row) {
        const double step = view.brightness(column, row) - own;
        if (step == 0) ++equal;
        if (step < darkest) {
            darkest = step;
            dark_x = column;
            dark_y = row;
        }
        if (step > brightest) {
            brightest = step;
            bright_x = column;
            bright_y = row;
        }
        return equal <= kFewEqual;
    });
    if (equal > kFewEqual || darkest == 0 || brightest == 0) return false;
    return (is_flat(view, dark_x, dark_y) && is_flat(other, dark_x, dark_y)) ||
           (is_flat(view, bright_x, bright_y) && is_flat(other, bright_x, bright_y));
}

template <class ExpectedSample, class ActualSample>
std::int64_t tolerate(const AlignedPair& pair, int first, int last, cv::Mat& marks) {
    const PixelView<ExpectedSample> expected(pair.expected, pair.alpha);
    const PixelView<ActualSample> actual(pair.actual, pair.alpha);
    std::int64_t count = 0;
    for (int y = first; y < last; ++y) {
        std::uint8_t* mark = marks.ptr(y);
        for (int x = 0; x < marks.cols; ++x) {
            if (mark[x] == 0) continue;
            if (!looks_antialiased(expected, actual, x, y) && !looks_antialiased(actual, expected, x, y)) continue;
            mark[x] = kAntialiased;
            ++count;
        }
    }
    return count;
}

using Tolerate = std::int64_t (*)(const AlignedPair&, int, int, cv::Mat&);

template <class ExpectedSample>
Tolerate tolerate_for(int actual_depth) {
    switch (actual_depth) {
        case CV_8U: return tolerate<ExpectedSample, std::uint8_t>;
        case CV_16U: return tolerate<ExpectedSample, std::uint16_t>;
        default: return tolerate<ExpectedSample, float>;
    }
}

Tolerate tolerate_for(const AlignedPair& pair) {
    const int actual_depth = pair.actual.depth();
    switch (pair.expected.depth()) {
        case CV_8U: return tolerate_for<std::uint8_t>(actual_depth);
        case CV_16U: return tolerate_for<std::uint16_t>(actual_depth);
        default: return tolerate_for<float>(actual_depth);
    }
}

}  // namespace

std::int64_t tolerate_antialiased(const AlignedPair& pair, cv::Mat& marks) {
    const Tolerate work = tolerate_for(pair);
    std::vector<std::int64_t> found(static_cast<std::size_t>((marks.rows + kBandRows - 1) / kBandRows));
    parallel_for(0, marks.rows, kBandRows, [&](int first, int last) {
        found[static_cast<std::size_t>(first / kBandRows)] = work(pair, first, last, marks);
    });
    return std::accumulate(found.begin(), found.end(), std::int64_t{0});
}

}  // namespace puppetwarp
