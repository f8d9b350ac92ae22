#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace puppetwarp {

//! The EXIF block without the `Exif\0\0` that JPEG puts in front of it: it begins with its TIFF header.
std::span<const std::uint8_t> without_exif_prefix(std::span<const std::uint8_t> block);

//! The orientation (1 to 8) that an EXIF block without prefix gives; 1 where it gives none or is damaged.
int exif_orientation(std::span<const std::uint8_t> exif);

//! Whether the first directory says how many pixels an inch or centimetre hold.
bool has_exif_resolution(std::span<const std::uint8_t> exif);

//! Sets the orientation to 1 in place, no other byte changes. Does nothing where the block gives none.
void reset_exif_orientation(std::vector<std::uint8_t>& exif);

}  // namespace puppetwarp
