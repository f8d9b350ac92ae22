#pragma once

#include <opencv2/core/mat.hpp>

#include <functional>

namespace puppetwarp {

//! Makes rows of a picture that is too large to be held at once. \param first_row  of the picture, that `rows` begins
//! with. \param rows  #rows x #cols, to be filled.
using FillRows = std::function<void(int first_row, cv::Mat& rows)>;

//! Is given rows of such a picture.
using TakeRows = std::function<void(int first_row, const cv::Mat& rows)>;

}  // namespace puppetwarp
