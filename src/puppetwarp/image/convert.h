#pragma once

#include <opencv2/core/mat.hpp>

#include <puppetwarp/image/formats.h>
#include <puppetwarp/image/picture_rows.h>

#include <cstdint>
#include <vector>

namespace puppetwarp {

//! Whether some pixel's alpha is below full.
bool has_transparency(const cv::Mat& pixels);

//! Whether an ICC profile describes colours of so many channels (grey or RGB): readers reject a file where not.
bool profile_fits(const std::vector<std::uint8_t>& icc, int channels);

//! The pixels as the format can hold them: colour to grey by luma (BT.709), alpha over white, depth rounded to the
//! nearest level. Returns the same memory where nothing is to do; the result is continuous.
cv::Mat fit_to_format(const cv::Mat& pixels, const FormatTraits& format);

//! The same for a picture that is made by rows.
PictureRows fit_to_format(const PictureRows& picture, const FormatTraits& format);

//! Rounds (or widens) to CV_8U, CV_16U or CV_32F; floats are clamped to [0, 1] first, NaN becomes 0.
cv::Mat to_depth(const cv::Mat& pixels, int depth);

}  // namespace puppetwarp
