#pragma once

#include <puppetwarp/diff/options.h>

#include <opencv2/core/mat.hpp>

namespace puppetwarp {

//! A move by whole pixels: pixel (x, y) of one picture lies on the other's (x + shift.x, y + shift.y).
struct Shift {
    int x = 0, y = 0;
};

//! Where, moved up to `reach_px` along x and y, two pictures of one size fit best: the mean absolute difference of what
//! both have is smallest; of several the shortest move, then the first in reading order. Pixels that are not selected
//! do not count (CV_8U, empty: all do). A move after which less than half of each side, or of what is selected, is left
//! to compare is none: little fits anything.
Shift best_shift(const cv::Mat& expected, const cv::Mat& actual, const cv::Mat& selected, AlphaRule alpha,
                 int reach_px);

//! The part of the expected picture that lies on the actual one, in its own pixels.
cv::Rect overlap(const cv::Size& size, const Shift& shift);

}  // namespace puppetwarp
