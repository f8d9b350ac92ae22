#pragma once

#include <puppetwarp/image/picture_file.h>

namespace puppetwarp {

bool is_png(const PictureFile& file);

//! What the frame of a PNG tells, which libvips keeps to itself.
struct PngFrame {
    bool has_resolution = false;
};

//! Walks over the chunks of a PNG and checks the last piece of its pixels. libpng checks each chunk when it comes to
//! the next one, so that of a damaged last piece nobody else would tell. \throw InvalidInput  the file ends early, or
//! the checksum of its last pixels is wrong.
PngFrame require_whole_png(const PictureFile& file);

}  // namespace puppetwarp
