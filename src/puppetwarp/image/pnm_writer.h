#pragma once

#include <puppetwarp/base/output_file.h>

#include <puppetwarp/image/picture_rows.h>

#include <string_view>

namespace puppetwarp {

//! Portable pixmaps: `pfm` from CV_32F, the others from CV_8U or CV_16U; 1 or 3 channels. Grey into `ppm` becomes RGB.
void write_pnm(const PictureRows& picture, std::string_view format, OutputFile& file);

}  // namespace puppetwarp
