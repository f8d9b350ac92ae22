#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/base/output_file.h>
#include <puppetwarp/image/write.h>

namespace puppetwarp {

//! Lossless WebP. \param pixels  continuous CV_8U; grey becomes RGB, which is all that the format knows.
void write_webp(const cv::Mat& pixels, const ImageMetadata& metadata, const WriteOptions& options, OutputFile& file);

}  // namespace puppetwarp
