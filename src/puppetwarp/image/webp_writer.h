#pragma once

#include <puppetwarp/base/output_file.h>
#include <puppetwarp/image/picture_rows.h>
#include <puppetwarp/image/write.h>

namespace puppetwarp {

//! Lossless WebP, whose encoder takes the whole picture.
//! \param picture  CV_8U; grey becomes RGB, which is all that the format knows.
void write_webp(const PictureRows& picture, const WriteOptions& options, OutputFile& file);

}  // namespace puppetwarp
