#include "model/folder_listing.h"

#include <puppetwarp/base/errors.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <string_view>
#include <system_error>

namespace puppetwarp::ui {

namespace {

namespace fs = std::filesystem;

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

bool is_picture_file(const fs::path& file) {
    static constexpr std::array<std::string_view, 20> extensions{
        ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".webp", ".gif", ".heic", ".heif", ".avif",
        ".ppm", ".pgm", ".pnm",  ".pbm", ".pfm",  ".exr",  ".hdr", ".jp2",  ".j2k",  ".jxl"};
    return std::find(extensions.begin(), extensions.end(), lower(file.extension().string())) != extensions.end();
}

}  // namespace

bool is_puppet_file(const fs::path& file) {
    return lower(file.extension().string()) == ".json";
}

bool is_of_kind(const fs::path& file, FileKind kind) {
    switch (kind) {
        case FileKind::openable: return is_puppet_file(file) || is_picture_file(file);
        case FileKind::puppets: return is_puppet_file(file);
        case FileKind::pictures: return is_picture_file(file);
    }
    return false;
}

std::vector<FolderEntry> list_folder(const fs::path& folder, FileKind kind) {
    std::error_code error;
    fs::directory_iterator at(folder, error);
    if (error) throw InvalidInput(folder.string(), error.message(), "choose another folder");
    std::vector<FolderEntry> entries;
    for (; !error && at != fs::directory_iterator(); at.increment(error)) {
        const std::string name = at->path().filename().string();
        if (name.starts_with('.')) continue;
        // Broken links and the like are no reason to show nothing of the folder.
        std::error_code ignored;
        if (at->is_directory(ignored)) {
            entries.push_back({name, true, 0});
        } else if (at->is_regular_file(ignored) && is_of_kind(name, kind)) {
            entries.push_back({name, false, at->file_size(ignored)});
        }
    }
    std::sort(entries.begin(), entries.end(), [](const FolderEntry& a, const FolderEntry& b) {
        if (a.is_folder != b.is_folder) return a.is_folder;
        const std::string lower_a = lower(a.name);
        const std::string lower_b = lower(b.name);
        return lower_a != lower_b ? lower_a < lower_b : a.name < b.name;
    });
    return entries;
}

std::string readable_size(std::uintmax_t bytes) {
    const double value = static_cast<double>(bytes);
    char text[32];
    if (value < 1e3) {
        std::snprintf(text, sizeof text, "%.0f B", value);
    } else if (value < 1e6) {
        std::snprintf(text, sizeof text, "%.0f KB", value / 1e3);
    } else if (value < 1e9) {
        std::snprintf(text, sizeof text, "%.1f MB", value / 1e6);
    } else {
        std::snprintf(text, sizeof text, "%.1f GB", value / 1e9);
    }
    return text;
}

}  // namespace puppetwarp::ui
