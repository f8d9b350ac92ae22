#include <puppetwarp/diff/antialiasing.h>

#include <puppetwarp/base/threads.h>
#include <puppetwarp/diff/row_reader.h>

#include <cstring>
#include <numeric>
#include <vector>

namespace puppetwarp {

namespace {

constexpr int kFewEqual = 2;  // neighbours as bright as the pixel itself, at most
constexpr int kFlat = 3;      // neighbours of the same colour, at least

// Single pixels of a picture, of any depth and number of channels.
class PixelView {
public:
    PixelView(const cv::Mat& pixels, AlphaRule alpha)
        : pixels_(pixels),
          blends_(pixels.channels() % 2 == 0 && alpha != AlphaRule::ignore),
          compared_bytes_(static_cast<std::size_t>(compared_channels(pixels, alpha)) * pixels.elemSize1()) {
        switch (pixels.depth()) {
            case CV_8U: brightness_ = brightness_of<std::uint8_t, 255>; break;
            case CV_16U: brightness_ = brightness_of<std::uint16_t, 65535>; break;
            default: brightness_ = brightness_of<float, 1>;
        }
    }

    int width() const { return pixels_.cols; }
    int height() const { return pixels_.rows; }
    double brightness(int x, int y) const { return brightness_(pixels_.ptr(y, x), pixels_.channels(), blends_); }
    bool equal(int x, int y, int other_x, int other_y) const {
        return std::memcmp(pixels_.ptr(y, x), pixels_.ptr(other_y, other_x), compared_bytes_) == 0;
    }

private:
    using Brightness = double (*)(const std::uint8_t* pixel, int channels, bool blends);

    // Luma over white. In whole numbers up to the blend, so that equal colours are equally bright to the bit.
    template <class Sample, int kFull>
    static double brightness_of(const std::uint8_t* pixel, int channels, bool blends) {
        const auto* sample = reinterpret_cast<const Sample*>(pixel);
        const double luma =
            channels < 3 ? 1000.0 * sample[0] : 299.0 * sample[0] + 587.0 * sample[1] + 114.0 * sample[2];
        return blends ? (luma - 1000.0 * kFull) * sample[channels - 1] : luma;
    }

    const cv::Mat& pixels_;
    bool blends_;
    std::size_t compared_bytes_;
    Brightness brightness_;
};

bool is_inside(const PixelView& view, int x, int y) {
    return x >= 0 && y >= 0 && x < view.width() && y < view.height();
}

bool is_at_border(const PixelView& view, int x, int y) {
    return x == 0 || y == 0 || x + 1 == view.width() || y + 1 == view.height();
}

// Calls `see(x, y)` for the up to eight neighbours of a pixel.
template <class See>
void for_each_neighbour(const PixelView& view, int x, int y, See&& see) {
    for (int row = y - 1; row <= y + 1; ++row) {
        for (int column = x - 1; column <= x + 1; ++column) {
            if ((row != y || column != x) && is_inside(view, column, row)) see(column, row);
        }
    }
}

bool is_flat(const PixelView& view, int x, int y) {
    int equal = is_at_border(view, x, y) ? 1 : 0;
    for_each_neighbour(view, x, y, [&](int column, int row) { equal += view.equal(x, y, column, row) ? 1 : 0; });
    return equal >= kFlat;
}

bool looks_antialiased(const PixelView& view, const PixelView& other, int x, int y) {
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
    });
    if (equal > kFewEqual || darkest == 0 || brightest == 0) return false;
    return (is_flat(view, dark_x, dark_y) && is_flat(other, dark_x, dark_y)) ||
           (is_flat(view, bright_x, bright_y) && is_flat(other, bright_x, bright_y));
}

}  // namespace

std::int64_t tolerate_antialiased(const AlignedPair& pair, cv::Mat& marks) {
    const PixelView expected(pair.expected, pair.alpha), actual(pair.actual, pair.alpha);
    std::vector<std::int64_t> found(static_cast<std::size_t>((marks.rows + kBandRows - 1) / kBandRows));
    parallel_for(0, marks.rows, kBandRows, [&](int first, int last) {
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
        found[static_cast<std::size_t>(first / kBandRows)] = count;
    });
    return std::accumulate(found.begin(), found.end(), std::int64_t{0});
}

}  // namespace puppetwarp
