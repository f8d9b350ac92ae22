#pragma once

#include <puppetwarp/base/output_file.h>
#include <puppetwarp/image/write.h>

#include <puppetwarp/image/picture_rows.h>

namespace puppetwarp {

//! `compression` 0 stores, 1 to 9 are Deflate with a predictor at libtiff's own level.
void write_tiff(const PictureRows& picture, const WriteOptions& options, OutputFile& file);

}  // namespace puppetwarp
