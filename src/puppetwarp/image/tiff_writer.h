#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/base/output_file.h>
#include <puppetwarp/image/write.h>

namespace puppetwarp {

//! \param pixels  continuous. `compression` 0 stores, 1 to 9 are Deflate with a predictor at libtiff's own level.
void write_tiff(const cv::Mat& pixels, const ImageMetadata& metadata, const WriteOptions& options, OutputFile& file);

}  // namespace puppetwarp
