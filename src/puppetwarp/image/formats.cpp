#include <puppetwarp/image/formats.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/output_file.h>
#include <puppetwarp/image/write.h>

#include <puppetwarp/image/convert.h>
#include <puppetwarp/image/jpeg_writer.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace puppetwarp {

namespace {

constexpr std::array<FormatTraits, 9> formats = {{
    {.name = "png", .alpha = true, .bits16 = true, .resolution = true, .icc = true, .exif = true, .xmp = true},
    {.name = "jpeg", .resolution = true, .icc = true, .exif = true, .xmp = true, .max_side_px = 65500},
    {.name = "tiff",
     .alpha = true,
     .bits16 = true,
     .floats = true,
     .resolution = true,
     .icc = true,
     .xmp = true},  // EXIF: libvips has no way to write that directory
    {.name = "webp", .grey = false, .alpha = true, .icc = true, .exif = true, .xmp = true, .max_side_px = 16383},
    {.name = "exr", .alpha = true, .floats = true, .resolution = true},
    {.name = "ppm", .bits16 = true},
    {.name = "pgm", .colour = false, .bits16 = true},
    {.name = "pnm", .bits16 = true},
    {.name = "pfm", .floats = true},
}};

struct Extension {
    std::string_view extension;
    std::string_view format;
};
constexpr std::array<Extension, 12> extensions = {{{"png", "png"},
                                                   {"jpg", "jpeg"},
                                                   {"jpeg", "jpeg"},
                                                   {"jpe", "jpeg"},
                                                   {"tif", "tiff"},
                                                   {"tiff", "tiff"},
                                                   {"webp", "webp"},
                                                   {"exr", "exr"},
                                                   {"ppm", "ppm"},
                                                   {"pgm", "pgm"},
                                                   {"pnm", "pnm"},
                                                   {"pfm", "pfm"}}};

std::string known_extensions() {
    std::string list;
    for (const Extension& known : extensions) list += (list.empty() ? "." : ", .") + std::string(known.extension);
    return list;
}

// How many channels the file's colours have, for its profile.
int channels_in(const FormatTraits& format, int channels) {
    return !format.grey ? 3 : !format.colour ? 1 : channels;
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

}  // namespace

const FormatTraits& format_traits(std::string_view name) {
    for (const FormatTraits& format : formats) {
        if (format.name == name) return format;
    }
    throw InvalidInput(std::string(name), "is not a picture format that can be written");
}

std::string output_format(const std::filesystem::path& path) {
    if (OutputFile::is_stream(path)) return "png";
    const std::string extension = lower(path.extension().string());
    for (const Extension& known : extensions) {
        if (extension.size() > 1 && extension.substr(1) == known.extension) return std::string(known.format);
    }
    throw InvalidInput(
        path.string(),
        extension.empty() ? "the file name has no extension" : "unknown picture extension '" + extension + "'",
        "use one of " + known_extensions());
}

bool format_holds_alpha(const std::string& format) {
    return format_traits(format).alpha;
}

std::vector<std::string> lost_in_format(const Image& image, const std::string& format) {
    const FormatTraits& traits = format_traits(format);
    const ImageMetadata& metadata = image.metadata;
    const bool resolution = metadata.x_pixels_per_mm > 0 && metadata.y_pixels_per_mm > 0;
    std::vector<std::string> lost;
    if (!traits.colour && image.pixels.channels() >= 3) lost.emplace_back("colour");
    if (!traits.alpha && has_transparency(image.pixels)) lost.emplace_back("alpha");
    if (image.pixels.depth() == CV_16U && !traits.bits16 && !traits.floats) lost.emplace_back("16 bits a channel");
    if (image.pixels.depth() == CV_32F && !traits.floats) lost.emplace_back("floating-point values");
    if (!metadata.icc.empty() &&
        !(traits.icc && profile_fits(metadata.icc, channels_in(traits, image.pixels.channels()))))
        lost.emplace_back("ICC profile");
    const bool jpeg = traits.name == "jpeg";
    if (!metadata.exif.empty() && !(traits.exif && !(jpeg && metadata.exif.size() > max_jpeg_exif_bytes)))
        lost.emplace_back("EXIF");
    if (!metadata.xmp.empty() && !(traits.xmp && !(jpeg && metadata.xmp.size() > max_jpeg_xmp_bytes)))
        lost.emplace_back("XMP");
    if (resolution && !traits.resolution) lost.emplace_back("resolution");
    return lost;
}

}  // namespace puppetwarp
