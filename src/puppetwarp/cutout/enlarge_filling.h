#pragma once
// Private header.

#include <puppetwarp/base/progress.h>
#include <puppetwarp/cutout/exemplar_fill.h>

#include <opencv2/core/mat.hpp>

namespace puppetwarp {

//! Fills the hole of a picture as the hole of its smaller self was filled: with pixels from the same places around,
//! found to the pixel, those of neighbouring patches blended into each other.
//!
//! Memory is that of the smaller picture; the same bytes for any number of threads.
//! \param smaller   what was filled, CV_32F: means of blocks of 2^halvings pixels along each axis.
//! \param hole      #rows x #cols, CV_8U, not 0 where the picture is not known.
//! \param pixels    #rows x #cols as in `Image`. Changed in the hole only.
//! \param progress  hears of the stage `background`; may cancel.
void enlarge_filling(const HoleFilling& filling, const cv::Mat& smaller, int halvings, const cv::Mat& hole,
                     cv::Mat& pixels, Progress& progress);

}  // namespace puppetwarp
