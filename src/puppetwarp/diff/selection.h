#pragma once

#include <puppetwarp/diff/options.h>

#include <opencv2/core/mat.hpp>

namespace puppetwarp {

//! Which pixels of a picture are compared: those of the mask that no rectangle takes away.
//! \return CV_8U, 1: compared, 0: not; empty: all are.
//! \throw InvalidInput  a mask of another size, a rectangle outside of the picture (one that reaches over its border is
//!        cut), nothing left.
cv::Mat selected_pixels(const CompareOptions& options, const cv::Size& size);

}  // namespace puppetwarp
