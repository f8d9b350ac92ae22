#pragma once

#include <string>
#include <string_view>

namespace puppetwarp {

//! A file name, or any text, for one line on a terminal or a page: valid UTF-8, of which control characters, marks that
//! turn the direction of writing, and bytes that are no UTF-8 are written `\xNN`.
std::string printable(std::string_view text);

}  // namespace puppetwarp
