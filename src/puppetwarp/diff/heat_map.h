#pragma once

#include <puppetwarp/diff/examine.h>

namespace puppetwarp {

//! The heat map of what was found out. \param expected  as examined.   \param examination  of comparable pictures.
Image heat_map_of(const Image& expected, const Examination& examination);

}  // namespace puppetwarp
