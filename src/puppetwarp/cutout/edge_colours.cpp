#include <puppetwarp/cutout/edge_colours.h>

#include <puppetwarp/base/threads.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace puppetwarp {

namespace {

constexpr int rows_a_task = 64;
constexpr int reach_px = 10;      // how far either side of an edge may be
constexpr double near_px = 6;     // from this distance on a side says less and less
constexpr int colours_of_px = 3;  // beyond the nearest pixel of a side, what else of it is looked at
// One row more is needed to tell what is a rim.
constexpr int looked_at_px = reach_px + colours_of_px;
constexpr double mixed_above = 0.9;  // from this coverage on a pixel is the subject's more and more
// Sides that differ by less, as a share of full scale, tell nothing apart.
constexpr double least_contrast = 0.02;

using Colour = std::array<double, 3>;

// What lies on either side of the edge. Pixels beside it may be mixed whatever their coverage says: they count where
// there are no others.
enum Place : std::uint8_t { on_edge, inside, inside_rim, outside, outside_rim };

double full_of(int depth) {
    return depth == CV_8U ? 255.0 : depth == CV_16U ? 65535.0 : 1.0;
}

cv::Mat places_of(const cv::Mat& matte) {
    cv::Mat places(matte.size(), CV_8U, cv::Scalar(on_edge));
    const auto mark = [&](const cv::Mat& mask, Place rim, Place core) {
        cv::Mat eroded;
        cv::erode(mask, eroded, cv::Mat::ones(3, 3, CV_8U));
        places.setTo(cv::Scalar(rim), mask);
        places.setTo(cv::Scalar(core), eroded);
    };
    mark(matte >= full_of(matte.depth()), inside_rim, inside);
    mark(matte <= 0, outside_rim, outside);
    return places;
}

// Pixels on one side of the edge, nearer ones counting more.
struct Side {
    Colour sum{};
    Colour low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    double weight = 0;
    int nearest = std::numeric_limits<int>::max();  // squared distance

    void add(const Colour& colour, int squared) {
        const double share = 1.0 / (static_cast<double>(squared) * squared);
        for (std::size_t c = 0; c < 3; ++c) {
            sum[c] += share * colour[c];
            low[c] = std::min(low[c], colour[c]);
            high[c] = std::max(high[c], colour[c]);
        }
        weight += share;
        nearest = std::min(nearest, squared);
    }
    Colour mean() const { return {sum[0] / weight, sum[1] / weight, sum[2] / weight}; }
    // How much it says, from 0 to 1.
    double trust() const {
        return weight > 0 ? std::clamp((reach_px - std::sqrt(nearest)) / (reach_px - near_px), 0.0, 1.0) : 0;
    }
};

template <class T>
class EdgeCleaner {
public:
    // Cleans rows [first, last).
    EdgeCleaner(const cv::Mat& pixels, const cv::Mat& matte, int first, int last)
        : pixels_(pixels),
          matte_(matte),
          first_(first),
          last_(last),
          top_(std::max(0, first - looked_at_px - 1)),
          places_(places_of(matte.rowRange(top_, std::min(matte.rows, last + looked_at_px + 1)))),
          full_coverage_(full_of(matte.depth())) {}

    // \param cut  the picture with its alpha.
    void clean(cv::Mat& cut) const {
        for (int y = first_; y < last_; ++y) {
            const std::uint8_t* place = places_.ptr<std::uint8_t>(y - top_);
            for (int x = 0; x < pixels_.cols; ++x) {
                if (place[x] == on_edge) clean(x, y, cut.ptr<T>(y) + cut.channels() * x);
            }
        }
    }

private:
    static constexpr double full = std::is_floating_point_v<T> ? 1.0 : static_cast<double>(static_cast<T>(-1));

    double coverage(int x, int y) const {
        switch (matte_.depth()) {
            case CV_8U: return matte_.at<std::uint8_t>(y, x) / full_coverage_;
            case CV_16U: return matte_.at<std::uint16_t>(y, x) / full_coverage_;
            default: return static_cast<double>(matte_.at<float>(y, x));
        }
    }

    Colour colour(int x, int y) const {
        Colour result{};
        const int channels = pixels_.channels();
        const T* pixel = pixels_.ptr<T>(y) + channels * x;
        for (int c = 0; c < channels; ++c) result[static_cast<std::size_t>(c)] = pixel[c] / full;
        return result;
    }

    // `body(column, row, squared distance)` for the pixels within `reach`.
    template <class Body>
    void around(int x, int y, int reach, const Body& body) const {
        for (int j = std::max(0, y - reach); j <= std::min(pixels_.rows - 1, y + reach); ++j) {
            for (int i = std::max(0, x - reach); i <= std::min(pixels_.cols - 1, x + reach); ++i) {
                const int squared = (i - x) * (i - x) + (j - y) * (j - y);
                if (squared <= reach * reach) body(i, j, squared);
            }
        }
    }

    // The pixels of a place that lie little farther than the nearest.
    Side side(Place wanted, int x, int y) const {
        Side found;
        int nearest = std::numeric_limits<int>::max();
        const auto is_wanted = [&](int i, int j) { return places_.at<std::uint8_t>(j - top_, i) == wanted; };
        around(x, y, reach_px, [&](int i, int j, int squared) {
            if (squared < nearest && is_wanted(i, j)) nearest = squared;
        });
        if (nearest == std::numeric_limits<int>::max()) return found;
        around(x, y, static_cast<int>(std::sqrt(nearest)) + colours_of_px, [&](int i, int j, int squared) {
            if (!is_wanted(i, j)) return;
            const Colour here = colour(i, j);
            if (std::isfinite(here[0] + here[1] + here[2])) found.add(here, squared);
        });
        return found;
    }
    Side side(Place core, Place rim, int x, int y) const {
        const Side found = side(core, x, y);
        return found.weight > 0 ? found : side(rim, x, y);
    }

    // How much of a colour is what is behind, told by the colours on either side. NaN for what is no number.
    static double share_of(const Colour& colour, const Colour& subject, const Colour& behind) {
        double along = 0, length = least_contrast * least_contrast;
        for (std::size_t c = 0; c < 3; ++c) {
            const double step = subject[c] - behind[c];
            along += (colour[c] - behind[c]) * step;
            length += step * step;
        }
        return std::min(1 - along / length, 1.0);
    }

    void clean(int x, int y, T* out) const {
        const Side inner = side(inside, inside_rim, x, y), outer = side(outside, outside_rim, x, y);
        double trust = std::min(inner.trust(), outer.trust());
        if (!(trust > 0)) return;
        const Colour here = colour(x, y), subject = inner.mean(), behind = outer.mean();
        const double share = share_of(here, subject, behind);
        if (!(share > 0)) return;
        // Where the outermost pixels that are covered in full, and so stay, show what is behind, the cutout is too
        // large: a clean pixel beyond them would stand alone.
        const Side rim = side(inside_rim, x, y);
        if (rim.weight > 0) trust *= std::clamp(1 - 2 * share_of(rim.mean(), subject, behind), 0.0, 1.0);
        const double mixed = std::min((1 - coverage(x, y)) / (1 - mixed_above), 1.0);
        for (std::size_t c = 0; c < static_cast<std::size_t>(pixels_.channels()); ++c) {
            const double moved = here[c] + share * (subject[c] - behind[c]);
            const double own = std::clamp(moved, inner.low[c], inner.high[c]);
            const double value = full * (here[c] + trust * mixed * (own - here[c]));
            out[c] = std::is_floating_point_v<T> ? static_cast<T>(value)
                                                 : static_cast<T>(std::clamp(value + 0.5, 0.0, full));
        }
    }

    const cv::Mat& pixels_;
    const cv::Mat& matte_;
    int first_, last_;
    int top_;  // row of the picture that is the first of `places_`
    cv::Mat places_;
    double full_coverage_;
};

}  // namespace

Image apply_clean_cutout(const Image& image, const Cutout& cutout) {
    Image cut = apply_cutout(image, cutout);
    if (cutout.whole || cutout.matte.empty() || image.has_alpha()) return cut;
    parallel_for(0, image.height(), rows_a_task, [&](int first, int last) {
        switch (image.pixels.depth()) {
            case CV_8U: return EdgeCleaner<std::uint8_t>(image.pixels, cutout.matte, first, last).clean(cut.pixels);
            case CV_16U: return EdgeCleaner<std::uint16_t>(image.pixels, cutout.matte, first, last).clean(cut.pixels);
            default: return EdgeCleaner<float>(image.pixels, cutout.matte, first, last).clean(cut.pixels);
        }
    });
    return cut;
}

}  // namespace puppetwarp
