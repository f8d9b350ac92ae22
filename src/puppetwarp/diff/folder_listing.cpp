#include <puppetwarp/diff/folder_listing.h>

#include <puppetwarp/base/errors.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <system_error>

namespace puppetwarp {

namespace fs = std::filesystem;

namespace {

// Links between a dozen folders can lead along more ways than anybody can walk.
constexpr int kMostFolders = 100'000;

// The last ones cannot be read. They are listed, and complained of, because folders with them must not pass as the
// same.
constexpr std::array<std::string_view, 26> kExtensions{
    ".png", ".jpg", ".jpeg", ".jpe", ".tif", ".tiff", ".webp", ".exr", ".gif",  ".heic", ".heif", ".avif", ".jp2",
    ".j2k", ".jpx", ".hdr",  ".ppm", ".pgm", ".pbm",  ".pnm",  ".pfm", ".apng", ".hif",  ".bmp",  ".tga",  ".jxl"};

bool has_picture_name(const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

class Walk {
public:
    explicit Walk(FolderListing& listing) : listing_(listing) {}

    // `prefix` is the folder's own path in the listing, with `/` at its end, or empty.
    void visit(const fs::path& folder, const std::string& prefix) {
        std::error_code error;
        const fs::path real = fs::canonical(folder, error);
        if (error) throw unreadable(folder, error);
        if (std::find(above_.begin(), above_.end(), real) != above_.end()) {
            listing_.loops.push_back(prefix.substr(0, prefix.size() - 1));
            return;
        }
        if (++folders_ > kMostFolders) {
            throw InvalidInput(folder.string(), "there are more than " + std::to_string(kMostFolders) + " folders",
                               "do symbolic links lead from each to each?");
        }
        above_.push_back(real);
        fs::directory_iterator entries(folder, error);
        if (error) throw unreadable(folder, error);
        for (; entries != fs::directory_iterator(); entries.increment(error)) {
            const std::string path = prefix + entries->path().filename().string();
            std::error_code unknown;  // where a link leads nowhere or round in a circle
            if (entries->is_directory(unknown)) {
                visit(entries->path(), path + '/');
            } else if (has_picture_name(path)) {
                listing_.pictures.push_back(path);
            }
        }
        if (error) throw unreadable(folder, error);
        above_.pop_back();
    }

private:
    static InvalidInput unreadable(const fs::path& folder, const std::error_code& error) {
        return {folder.string(), "the folder cannot be read: " + error.message()};
    }

    FolderListing& listing_;
    int folders_ = 0;
    std::vector<fs::path> above_;  // the folders that the present one lies in, and itself
};

}  // namespace

FolderListing list_pictures(const fs::path& folder) {
    FolderListing listing;
    Walk(listing).visit(folder, "");
    std::sort(listing.pictures.begin(), listing.pictures.end());
    std::sort(listing.loops.begin(), listing.loops.end());
    return listing;
}

}  // namespace puppetwarp
