#pragma once

#include <puppetwarp/base/image.h>

namespace puppetwarp::ui {

//! A picture made ready for the screen: #rows x #cols of CV_8UC4, RGB premultiplied by alpha, shrunk where a side is
//! longer than `longest_side_px`. For showing only: exports start from the picture itself.
cv::Mat shown_picture(const Image& image, int longest_side_px);

}  // namespace puppetwarp::ui
