#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace puppetwarp {

//! Checks that a path can be read as a file before anybody opens it: a pipe would block, a folder would be misread.
//! \throw InvalidInput  missing, a folder, a pipe or a device, no permission, empty.
void require_readable_file(const std::filesystem::path& path);

//! A whole text file. \throw InvalidInput  `require_readable_file`, more than `max_bytes`.
std::string read_file(const std::filesystem::path& path, std::size_t max_bytes);

}  // namespace puppetwarp
