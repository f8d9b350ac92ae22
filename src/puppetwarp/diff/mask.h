#pragma once

#include <puppetwarp/base/image.h>

namespace puppetwarp {

//! A mask for `CompareOptions::mask` from a picture: 1 where it is white, 0 where it is black or transparent (luma
//! times alpha against one half).
cv::Mat comparison_mask(const Image& picture);

}  // namespace puppetwarp
