#pragma once

#include <puppetwarp/base/output_file.h>
#include <puppetwarp/image/picture_rows.h>
#include <puppetwarp/image/write.h>

#include <cstddef>

namespace puppetwarp {

// One JPEG segment holds 65533 bytes; what does not fit beside its identifier is lost.
constexpr std::size_t max_jpeg_exif_bytes = 65533 - 6;
constexpr std::size_t max_jpeg_xmp_bytes = 65533 - 29;

//! \param picture  1 or 3 channels of CV_8U. Chroma keeps its full resolution from quality 90 on.
void write_jpeg(const PictureRows& picture, const WriteOptions& options, OutputFile& file);

}  // namespace puppetwarp
