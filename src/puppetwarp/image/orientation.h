#pragma once

#include <opencv2/core/mat.hpp>

namespace puppetwarp {

//! Turns and mirrors stored pixels so that they stand upright. Half turns and horizontal mirrors work in place.
//! \param orientation  EXIF 2.32 orientation, 1 (upright already) to 8.
cv::Mat upright(cv::Mat stored, int orientation);

//! Whether the orientation swaps width and height.
constexpr bool swaps_sides(int orientation) {
    return orientation >= 5;
}

}  // namespace puppetwarp
