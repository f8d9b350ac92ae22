#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/base/output_file.h>
#include <puppetwarp/image/write.h>

#include <cstddef>

namespace puppetwarp {

// One JPEG segment holds 65533 bytes; what does not fit beside its identifier is lost.
constexpr std::size_t max_jpeg_exif_bytes = 65533 - 6;
constexpr std::size_t max_jpeg_xmp_bytes = 65533 - 29;

//! \param pixels  continuous, 1 or 3 channels of CV_8U. Chroma keeps its full resolution from quality 90 on.
void write_jpeg(const cv::Mat& pixels, const ImageMetadata& metadata, const WriteOptions& options, OutputFile& file);

}  // namespace puppetwarp
