#pragma once
// Private header.

#include <opencv2/core/mat.hpp>

namespace puppetwarp {

//! Spreads what is known smoothly over what is not: means of ever larger neighbourhoods, each where the smaller ones
//! know nothing. Nearly the membrane that is fixed at the known pixels, in time linear in the pixels.
//! Pull and push: Gortler et al. 1996, "The Lumigraph".
//!
//! \param values  #rows x #cols, CV_32F, any channels.
//! \param known   #rows x #cols, CV_8U: not 0 where `values` are to be kept; somewhere it must be.
cv::Mat membrane(const cv::Mat& values, const cv::Mat& known);

}  // namespace puppetwarp
