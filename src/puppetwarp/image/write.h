#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/image/picture_rows.h>

#include <filesystem>
#include <string>
#include <vector>

namespace puppetwarp {

struct WriteOptions {
    int compression =
        1;             //!< of PNG, WebP (lossless always) and EXR, 0 (fast) to 9 (small); TIFF: 0 stored, else Deflate
    int quality = 95;  //!< of JPEG, 1 to 100; chroma keeps its full resolution from 90 on
};

//! The file formats that can be written, by extension: png, jpg/jpeg/jpe, tif/tiff, webp, exr, ppm/pgm/pnm/pfm.
//! What `OutputFile` writes directly (`-`, `/dev/stdout`, pipes, devices) is PNG.
//! \throw InvalidInput  unknown extension (names the known ones).
std::string output_format(const std::filesystem::path& path);

//! True when files of this format can have an alpha channel. \throw InvalidInput  unknown format.
bool format_holds_alpha(const std::string& format);

//! What of this picture a file format cannot hold, each as a phrase for a person ("alpha", "16 bits a channel",
//! "EXIF"); empty when everything is kept. Alpha that is full everywhere is nothing to lose.
std::vector<std::string> lost_in_format(const Image& image, const std::string& format);

//! Writes a picture in the format of the path's extension with its depth, alpha and metadata, whole or not at all
//! (`OutputFile`). What `lost_in_format` names is converted (alpha over white, 16 bits rounded to 8).
//! \throw InvalidInput  unknown extension, missing or read-only folder.   \throw MachineFault  disk full.
void write_image(const Image& image, const std::filesystem::path& path, const WriteOptions& options = {});

//! The same for a picture that is made while it is written, a part at a time (WebP takes it as a whole).
//! \throw InvalidInput, MachineFault  as above; what making the rows throws.
void write_rows(const PictureRows& picture, const std::filesystem::path& path, const WriteOptions& options = {});

}  // namespace puppetwarp
