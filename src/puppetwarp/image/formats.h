#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace puppetwarp {

//! What one file format can hold, as this program writes it.
struct FormatTraits {
    std::string_view name;  //!< as `output_format` gives it
    bool grey = true;       //!< false: grey becomes RGB
    bool colour = true;
    bool alpha = false;
    bool bits16 = false;
    bool floats = false;  //!< floats only, where `bits16` is false (8 and 16 bits become floats without loss)
    bool resolution = false;
    bool icc = false;
    bool exif = false;
    bool xmp = false;
    int max_side_px = 0;  //!< 0: no limit that a picture reaches
};

//! \throw InvalidInput  no such format.
const FormatTraits& format_traits(std::string_view name);

}  // namespace puppetwarp
