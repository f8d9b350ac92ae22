#include <puppetwarp/diff/metadata_difference.h>

#include <cmath>
#include <cstdint>
#include <sstream>

namespace puppetwarp {

namespace {

// Files round: a PNG to whole pixels a metre.
constexpr double kResolutionStep_mm = 1e-3;

std::string block_phrase(const std::vector<std::uint8_t>& block) {
    return block.empty() ? "none" : std::to_string(block.size()) + " bytes";
}

void compare_blocks(const std::string& what, const std::vector<std::uint8_t>& expected,
                    const std::vector<std::uint8_t>& actual, std::vector<std::string>& differences) {
    if (expected == actual) return;
    const bool as_long = expected.size() == actual.size();
    differences.push_back(
        what + (as_long ? " of equal length differs"
                        : " differs: expected " + block_phrase(expected) + ", actual " + block_phrase(actual)));
}

std::string resolution_phrase(const ImageMetadata& metadata) {
    if (metadata.x_pixels_per_mm <= 0) return "none";
    std::ostringstream text;
    text << metadata.x_pixels_per_mm << " x " << metadata.y_pixels_per_mm << " pixels a mm";
    return text.str();
}

}  // namespace

std::vector<std::string> metadata_differences(const ImageMetadata& expected, const ImageMetadata& actual) {
    std::vector<std::string> differences;
    compare_blocks("the ICC profile", expected.icc, actual.icc, differences);
    compare_blocks("EXIF", expected.exif, actual.exif, differences);
    compare_blocks("XMP", expected.xmp, actual.xmp, differences);
    if (std::abs(expected.x_pixels_per_mm - actual.x_pixels_per_mm) > kResolutionStep_mm ||
        std::abs(expected.y_pixels_per_mm - actual.y_pixels_per_mm) > kResolutionStep_mm) {
        differences.push_back("the resolution differs: expected " + resolution_phrase(expected) + ", actual " +
                              resolution_phrase(actual));
    }
    return differences;
}

}  // namespace puppetwarp
