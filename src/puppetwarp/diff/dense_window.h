#pragma once

#include <opencv2/core/mat.hpp>

#include <cstdint>

namespace puppetwarp {

//! A square of pixels, cut where the picture is smaller.
struct DenseWindow {
    int pixels = 0;  //!< that bear the mark
    int x = 0, y = 0;
};

//! The square of `side_px` with most marked pixels; of several the first in reading order.
//! \param marks  CV_8U.   \param side_px  at least 1.
DenseWindow densest_window(const cv::Mat& marks, std::uint8_t mark, int side_px);

}  // namespace puppetwarp
