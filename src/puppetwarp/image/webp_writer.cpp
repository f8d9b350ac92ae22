#include <puppetwarp/image/webp_writer.h>

#include <puppetwarp/base/errors.h>

#include <puppetwarp/image/bytes.h>
#include <puppetwarp/image/convert.h>
#include <puppetwarp/image/vips_output.h>

#include <string>
#include <string_view>

// The container of RFC 9649, section 2.7. libvips encodes the pixels; the metadata chunks are added here, because
// libvips takes EXIF apart and adds fields of its own.

namespace puppetwarp {

namespace {

constexpr std::uint8_t icc_flag = 0x20;
constexpr std::uint8_t alpha_flag = 0x10;
constexpr std::uint8_t exif_flag = 0x08;
constexpr std::uint8_t xmp_flag = 0x04;

void append_chunk(std::string& webp, std::string_view four_letters, std::string_view body) {
    webp += four_letters;
    append_le(webp, static_cast<std::uint32_t>(body.size()), 4);
    webp += body;
    if (body.size() % 2 != 0) webp += '\0';
}

// The one chunk of lossless pixels in what libvips wrote.
std::string_view pixel_chunk(std::string_view webp, const std::string& name) {
    for (std::size_t at = 12; at + 8 <= webp.size();) {
        std::uint32_t size = 0;
        for (int i = 3; i >= 0; --i) size = size << 8 | static_cast<unsigned char>(webp[at + 4 + i]);
        if (webp.substr(at, 4) == "VP8L") return webp.substr(at + 8, size);
        at += 8 + size + size % 2;
    }
    throw MachineFault(name, "cannot be encoded as WebP");
}

std::string extended_header(const cv::Mat& pixels, std::uint8_t flags) {
    std::string body(1, static_cast<char>(flags));
    append_le(body, 0, 3);
    append_le(body, static_cast<std::uint32_t>(pixels.cols - 1), 3);
    append_le(body, static_cast<std::uint32_t>(pixels.rows - 1), 3);
    return body;
}

std::string with_metadata(std::string_view pixels_chunk, const cv::Mat& pixels, const ImageMetadata& metadata) {
    // WebP stores grey as RGB: a grey profile would no longer fit.
    const bool icc = profile_fits(metadata.icc, 3);
    const int flags = (icc ? icc_flag : 0) | (pixels.channels() % 2 == 0 ? alpha_flag : 0) |
                      (metadata.exif.empty() ? 0 : exif_flag) | (metadata.xmp.empty() ? 0 : xmp_flag);
    std::string chunks = "WEBP";
    if ((flags & ~alpha_flag) != 0)
        append_chunk(chunks, "VP8X", extended_header(pixels, static_cast<std::uint8_t>(flags)));
    if (icc) append_chunk(chunks, "ICCP", as_text(metadata.icc));
    append_chunk(chunks, "VP8L", pixels_chunk);
    if (!metadata.exif.empty()) append_chunk(chunks, "EXIF", as_text(metadata.exif));
    if (!metadata.xmp.empty()) append_chunk(chunks, "XMP ", as_text(metadata.xmp));
    std::string webp = "RIFF";
    append_le(webp, static_cast<std::uint32_t>(chunks.size()), 4);
    return webp + chunks;
}

}  // namespace

void write_webp(const PictureRows& picture, const WriteOptions& options, OutputFile& file) {
    require_vips();
    cv::Mat pixels = picture.rows(0, picture.height);
    if (!pixels.isContinuous()) pixels = pixels.clone();
    const std::string name = file.target().string();
    const VipsImagePtr image = vips_view(pixels);
    const int effort = options.compression * 6 / 9;
    const std::string webp = encoded(name, [&](void** bytes, std::size_t* count) {
        return vips_webpsave_buffer(image.get(), bytes, count, "lossless", TRUE, "effort", effort, "strip", TRUE,
                                    nullptr);
    });
    file.write(with_metadata(pixel_chunk(webp, name), pixels, picture.metadata));
}

}  // namespace puppetwarp
