#include <puppetwarp/diff/folder_outputs.h>

#include <puppetwarp/base/errors.h>

#include <puppetwarp/diff/side_by_side.h>
#include <puppetwarp/image/write.h>

#include <optional>
#include <system_error>
#include <utility>

namespace puppetwarp {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLongestName = 255;  // bytes, of every file system in use

// The pair's index keeps names apart that begin alike.
std::string name_with(std::string name, std::size_t pair, const std::string& ending) {
    if (name.size() + ending.size() <= kLongestName) return name + ending;
    const std::string tail = '~' + std::to_string(pair) + ending;
    std::size_t end = kLongestName - tail.size();
    while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xc0U) == 0x80U) --end;  // no half letters of UTF-8
    return name.substr(0, end) + tail;
}

void write_below(const fs::path& folder, const fs::path& path, std::size_t pair, const char* ending,
                 const Image& picture) {
    const fs::path target = folder / path.parent_path() / name_with(path.filename().string(), pair, ending);
    std::error_code error;
    fs::create_directories(target.parent_path(), error);
    if (error) throw InvalidInput(target.parent_path().string(), "the folder cannot be made: " + error.message());
    write_image(picture, target);
}

}  // namespace

FolderOutputs::FolderOutputs(Folders folders, bool page) : folders_(std::move(folders)), page_(page) {}

void FolderOutputs::see(std::size_t pair, const std::string& path, const ComparedFiles& files) {
    if (files.comparison.same) return;
    write_pictures(pair, path, files);
    if (!page_ || kept_bytes_ >= HtmlReport::usual_room_bytes) return;
    HtmlReport::Pictures pictures = HtmlReport::pictures_of(files);
    const std::lock_guard lock(mutex_);
    unsettled_[pair] = std::move(pictures);
}

void FolderOutputs::write_pictures(std::size_t pair, const std::string& path, const ComparedFiles& files) const {
    if (!folders_.heat_maps.empty() && files.comparison.comparable) {
        write_below(folders_.heat_maps, path, pair, ".heatmap.png", files.heat_map);
    }
    if (!folders_.side_by_sides.empty()) {
        write_below(folders_.side_by_sides, path, pair, ".side-by-side.png", side_by_side(files));
    }
}

void FolderOutputs::settle(std::size_t /*first*/, std::size_t /*last*/) {
    for (auto& [pair, pictures] : unsettled_) {
        if (kept_bytes_ >= HtmlReport::usual_room_bytes) break;
        kept_bytes_ += pictures.bytes();
        kept_[pair] = std::move(pictures);
    }
    unsettled_.clear();
}

HtmlReport FolderOutputs::page(const fs::path& expected, const fs::path& actual, const FolderComparison& comparison) {
    HtmlReport report(expected, actual);
    for (std::size_t i = 0; i < comparison.pairs.size(); ++i) {
        const auto found = kept_.find(i);
        report.add(comparison.pairs[i], found == kept_.end() ? std::nullopt : std::optional(std::move(found->second)));
    }
    kept_.clear();
    return report;
}

}  // namespace puppetwarp
