#pragma once
// Private header.

#include <puppetwarp/base/progress.h>

#include <opencv2/core/mat.hpp>

namespace puppetwarp {

//! Fills the hole of a picture with what is around it: with patches that go on with what ends there, from coarse
//! pictures to fine, and with a membrane where none fits.
//!
//! \param picture   #rows x #cols, CV_32F, 1 to 4 channels of full scale 1; alpha premultiplied. Changed in the hole
//! only. \param hole      #rows x #cols, CV_8U, not 0 where the picture is not known; somewhere it must be. \param
//! progress  hears of the stage `background`; may cancel.
void fill_hole(cv::Mat& picture, const cv::Mat& hole, Progress& progress);

}  // namespace puppetwarp
