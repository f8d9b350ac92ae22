#include <puppetwarp/image/jpeg_writer.h>

#include <puppetwarp/image/bytes.h>
#include <puppetwarp/image/convert.h>
#include <puppetwarp/image/vips_output.h>
#include <puppetwarp/image/vips_rows.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

// ITU-T T.81 (segments), T.871 (JFIF), EXIF 2.32, XMP part 3, ICC.1 annex B.4. libvips encodes the pixels; the
// segments in front are made here, because libvips takes EXIF apart and adds fields of its own.

namespace puppetwarp {

namespace {

using namespace std::literals;

constexpr std::uint8_t app0 = 0xe0;
constexpr std::uint8_t app1 = 0xe1;
constexpr std::uint8_t app2 = 0xe2;

void append_segment(std::string& jpeg, std::uint8_t marker, std::string_view identifier, std::string_view body) {
    jpeg += '\xff';
    jpeg += static_cast<char>(marker);
    append_be16(jpeg, static_cast<std::uint16_t>(2 + identifier.size() + body.size()));
    jpeg += identifier;
    jpeg += body;
}

// Density is in whole numbers: in inches or centimetres, whichever comes nearer.
std::string jfif_body(const ImageMetadata& metadata) {
    constexpr double largest = 65535;
    const double x = metadata.x_pixels_per_mm;
    const double y = metadata.y_pixels_per_mm;
    const bool known = x > 0 && y > 0;
    const auto error = [](double density) { return std::abs(density - std::round(density)) / density; };
    const bool inches = known && error(x * 25.4) + error(y * 25.4) <= error(x * 10) + error(y * 10);
    const double factor = inches ? 25.4 : 10;
    const auto density = [&](double per_mm) {
        return static_cast<std::uint16_t>(known ? std::clamp(std::round(per_mm * factor), 1.0, largest) : 1);
    };
    std::string body = "\x01\x02"s;  // version 1.02
    body += static_cast<char>(!known ? 0 : inches ? 1 : 2);
    append_be16(body, density(x));
    append_be16(body, density(y));
    body += "\0\0"sv;  // no thumbnail
    return body;
}

void append_profile(std::string& jpeg, std::string_view icc) {
    constexpr std::size_t largest = 65533 - 14;
    const std::size_t pieces = (icc.size() + largest - 1) / largest;
    if (pieces > 255) return;
    for (std::size_t i = 0; i < pieces; ++i) {
        std::string identifier("ICC_PROFILE\0"sv);
        identifier += static_cast<char>(i + 1);
        identifier += static_cast<char>(pieces);
        append_segment(jpeg, app2, identifier, icc.substr(i * largest, largest));
    }
}

std::string leading_segments(const ImageMetadata& metadata, int channels) {
    std::string jpeg = "\xff\xd8";
    append_segment(jpeg, app0, "JFIF\0"sv, jfif_body(metadata));
    if (!metadata.exif.empty() && metadata.exif.size() <= max_jpeg_exif_bytes)
        append_segment(jpeg, app1, "Exif\0\0"sv, as_text(metadata.exif));
    if (!metadata.xmp.empty() && metadata.xmp.size() <= max_jpeg_xmp_bytes)
        append_segment(jpeg, app1, "http://ns.adobe.com/xap/1.0/\0"sv, as_text(metadata.xmp));
    if (profile_fits(metadata.icc, channels)) append_profile(jpeg, as_text(metadata.icc));
    return jpeg;
}

}  // namespace

void write_jpeg(const PictureRows& picture, const WriteOptions& options, OutputFile& file) {
    require_vips();
    const VipsRows rows(picture);
    const std::string jpeg = encoded(file.target().string(), [&](void** bytes, std::size_t* count) {
        const int status = vips_jpegsave_buffer(
            rows.image(), bytes, count, "Q", options.quality, "subsample_mode",
            options.quality >= 90 ? VIPS_FOREIGN_SUBSAMPLE_OFF : VIPS_FOREIGN_SUBSAMPLE_ON, "strip", TRUE, nullptr);
        rows.rethrow_failure();
        return status;
    });
    file.write(leading_segments(picture.metadata, CV_MAT_CN(picture.type)));
    file.write(std::string_view(jpeg).substr(2));  // after its start-of-image marker
}

}  // namespace puppetwarp
