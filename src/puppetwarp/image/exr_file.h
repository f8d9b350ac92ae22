#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/base/output_file.h>
#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>

#include <puppetwarp/image/picture_file.h>
#include <puppetwarp/image/picture_rows.h>

namespace puppetwarp {

// OpenEXR through its own library: libvips reads halves only and cannot write. Files hold colour multiplied by alpha,
// Images do not: reading divides (where alpha is 0 the colour stays as it is), writing multiplies.

bool is_exr(const PictureFile& file);

//! The first part's `R G B [A]` or `Y [A]`, as CV_32F, over its data window.
//! \throw InvalidInput  damaged, deep, other channels, luminance with chroma, over `max_pixels`.
Image read_exr(const PictureFile& file, const ReadOptions& options);
ImageInfo read_exr_info(const PictureFile& file, const ReadOptions& options);

//! \param picture  CV_32F, 1 to 4 channels; written as 32-bit floats, ZIP-compressed unless `compression` is 0.
void write_exr(const PictureRows& picture, const WriteOptions& options, OutputFile& file);

}  // namespace puppetwarp
