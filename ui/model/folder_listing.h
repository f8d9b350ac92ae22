#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace puppetwarp::ui {

//! One line of a file browser.
struct FolderEntry {
    std::string name;
    bool is_folder = false;
    std::uintmax_t size_bytes = 0;  //!< of files
};

//! Which files a browser shows.
enum class FileKind { openable, puppets, pictures };

//! True when the name's extension is one of this kind.
bool is_of_kind(const std::filesystem::path& file, FileKind kind);

//! The folders and the files of this kind in a folder, folders first, by name without regard to case; hidden ones
//! are left out. \throw InvalidInput  missing, not a folder, unreadable.
std::vector<FolderEntry> list_folder(const std::filesystem::path& folder, FileKind kind);

//! True for the names of puppet files, `NAME.puppet.json` by custom.
bool is_puppet_file(const std::filesystem::path& file);

//! `12 KB`, `3.4 MB`.
std::string readable_size(std::uintmax_t bytes);

}  // namespace puppetwarp::ui
