#pragma once

#include <puppetwarp/base/image.h>

#include <string>
#include <vector>

namespace puppetwarp {

//! What differs between two pictures beside their pixels, a phrase each: ICC profile, EXIF, XMP, physical resolution
//! (by more than a pixel a metre). The orientation in the file is no longer known here.
std::vector<std::string> metadata_differences(const ImageMetadata& expected, const ImageMetadata& actual);

}  // namespace puppetwarp
