#pragma once

#include <puppetwarp/base/image.h>

#include <cstdint>
#include <filesystem>
#include <string>

namespace puppetwarp {

struct ReadOptions {
    std::int64_t max_pixels = 200'000'000;  //!< refuse larger pictures by their header, before decoding
};

//! What a picture's header says, before and after EXIF orientation is applied.
struct ImageInfo {
    std::string format;  //!< `png`, `jpeg`, `tiff`, `webp`, `gif`, `heif`, `exr`, ...
    int width = 0;       //!< pixels, with the orientation applied
    int height = 0;
    int channels = 0;  //!< as `read_image` will give them
    int bits = 8;      //!< 8, 16 or 32 (float) a channel, as `read_image` will give them
    bool has_alpha = false;
    bool has_icc = false;
    bool has_exif = false;
    bool has_xmp = false;
    int orientation = 1;  //!< EXIF orientation of the file, 1 to 8
    int pages = 1;
    double x_pixels_per_mm = 0;
    double y_pixels_per_mm = 0;
};

//! Reads a picture: depth, alpha, ICC, EXIF and XMP are kept, EXIF orientation is applied to the pixels,
//! a palette becomes RGB, CMYK becomes sRGB through its profile, of several pages the first.
//! \throw InvalidInput  missing, a folder, a pipe, empty, unreadable, truncated, not a picture, over `max_pixels`.
Image read_image(const std::filesystem::path& path, const ReadOptions& options = {});

//! Reads a picture's header only. \throw InvalidInput  as `read_image`, as far as the header tells.
ImageInfo read_image_info(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace puppetwarp
