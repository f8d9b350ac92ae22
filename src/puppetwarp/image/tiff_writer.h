#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/base/output_file.h>
#include <puppetwarp/image/write.h>

#include <puppetwarp/image/fill_rows.h>

namespace puppetwarp {

//! \param pixels  continuous. `compression` 0 stores, 1 to 9 are Deflate with a predictor at libtiff's own level.
void write_tiff(const cv::Mat& pixels, const ImageMetadata& metadata, const WriteOptions& options, OutputFile& file);

//! Writes a picture of 32-bit floats whose rows are made while they are written.
//! \param fill  called from several threads at a time; what it throws is passed on.
void write_tiff_rows(int width, int height, int channels, const FillRows& fill, const WriteOptions& options,
                     OutputFile& file);

}  // namespace puppetwarp
