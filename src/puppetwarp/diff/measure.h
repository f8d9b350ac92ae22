#pragma once

#include <puppetwarp/diff/options.h>

#include <opencv2/core/mat.hpp>

#include <cstdint>

namespace puppetwarp {

// What is known of a pixel: bits of a map of marks, CV_8U.
inline constexpr std::uint8_t kSlight = 1;       //!< a channel differs by more than the window's threshold
inline constexpr std::uint8_t kOver = 2;         //!< it differs by more than the metric's threshold
inline constexpr std::uint8_t kAntialiased = 4;  //!< it would, but looks antialiased: the other bits are 0

//! Rows a task of every pass over a picture. The bands, and so the order in which floating sums are added, depend on
//! nothing else.
inline constexpr int kBandRows = 32;

//! The pixels that are looked at: of two pictures, the parts that fit, and of these the selected ones.
struct AlignedPair {
    cv::Mat expected;
    cv::Mat actual;    //!< of the same size and as many compared channels
    cv::Mat selected;  //!< CV_8U of this size, 1: compared, 0: not; empty: all are
    std::int64_t selected_pixels = 0;
    AlphaRule alpha = AlphaRule::straight;

    const std::uint8_t* selected_row(int y) const { return selected.empty() ? nullptr : selected.ptr(y); }
};

//! Differences channel by channel, on a scale of 0 to 1.
struct ChannelFigures {
    double max = 0;
    int max_x = -1, max_y = -1, max_channel = -1;  //!< the first in reading order; -1: nothing differs
    double mean = 0;
    double mean_square = 0;
};

//! Measures the selected pixels, and marks those of which a channel differs by more than the thresholds.
//! \param marks  CV_8U, all 0 at first; gets `kSlight` and, unless `over_threshold` is negative, `kOver`.
ChannelFigures measure(const AlignedPair& pair, double slight_threshold, double over_threshold, cv::Mat& marks);

//! How many pixels bear a mark, and the smallest rectangle around them (no size: none do).
struct MarkedArea {
    std::int64_t pixels = 0;
    PixelRect box;
};
MarkedArea marked_area(const cv::Mat& marks, std::uint8_t mark);

}  // namespace puppetwarp
