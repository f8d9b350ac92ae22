#pragma once

#include <puppetwarp/image/picture_file.h>

#include <opencv2/core/mat.hpp>

namespace puppetwarp {

//! The pixels of a plain PNG, unpacked in one go: several times as fast as libpng, which goes piece by piece. Plain is
//! a file of 8 or 16 bits a channel without palette, transparent colour and interlacing, of which all checksums are
//! right.
//! \param type  what the file was found to hold: CV_8UC1 .. CV_16UC4.
//! \return empty where the file is not plain, anything about it is wrong, or it unpacks to more than 192 MB: libvips
//!         shall read it then, and say what is wrong.
cv::Mat plain_png_pixels(const PictureFile& file, int width, int height, int type);

}  // namespace puppetwarp
