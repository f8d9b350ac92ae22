#include "test_pictures.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <random>
#include <stdexcept>

#include <vips/vips.h>
#include <zlib.h>

// The HEVC encoder, which only the tests call, never gives back a little of its memory.
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libx265";
}

namespace puppetwarp::test {

namespace {

void start_vips() {
    static const int status = vips_init("unit_image");
    if (status != 0) throw std::runtime_error("libvips does not start");
    // Tests write one name again and again; a cached picture would be the one before.
    vips_cache_set_max(0);
}

[[noreturn]] void vips_failed() {
    const std::string text = vips_error_buffer();
    vips_error_clear();
    throw std::runtime_error(text);
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "puppetwarp-test-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

cv::Mat noise(int width, int height, int depth, int channels, unsigned seed) {
    cv::Mat pixels(height, width, CV_MAKETYPE(depth, channels));
    std::mt19937 random(seed);
    for (int y = 0; y < height; ++y) {
        for (int i = 0; i < width * channels; ++i) {
            const std::uint32_t value = static_cast<std::uint32_t>(random());
            if (depth == CV_8U) pixels.ptr<std::uint8_t>(y)[i] = static_cast<std::uint8_t>(value >> 24);
            if (depth == CV_16U) pixels.ptr<std::uint16_t>(y)[i] = static_cast<std::uint16_t>(value >> 16);
            if (depth == CV_32F) pixels.ptr<float>(y)[i] = static_cast<float>(value >> 8) / 16777216.0f;
        }
    }
    return pixels;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
    if (a.size() != b.size() || a.type() != b.type()) return false;
    for (int y = 0; y < a.rows; ++y) {
        if (std::memcmp(a.ptr(y), b.ptr(y), static_cast<std::size_t>(a.cols) * a.elemSize()) != 0) return false;
    }
    return true;
}

std::string file_bytes(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

void store(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

std::string be16(unsigned value) {
    return {static_cast<char>(value >> 8), static_cast<char>(value)};
}
std::string be32(unsigned value) {
    return be16(value >> 16) + be16(value & 0xffff);
}
std::string le16(unsigned value) {
    return {static_cast<char>(value), static_cast<char>(value >> 8)};
}
std::string le32(unsigned value) {
    return le16(value & 0xffff) + le16(value >> 16);
}

std::string png_chunk(const std::string& name, const std::string& body) {
    const std::string counted = name + body;
    const uLong crc = crc32(0, reinterpret_cast<const Bytef*>(counted.data()), static_cast<uInt>(counted.size()));
    return be32(static_cast<unsigned>(body.size())) + counted + be32(static_cast<unsigned>(crc));
}

std::string png_file(unsigned width, unsigned height, int bits, int colour_type, const std::string& rows,
                     const std::string& extra) {
    uLongf size = compressBound(rows.size());
    std::string packed(size, '\0');
    compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(rows.data()), rows.size());
    packed.resize(size);
    const std::string header =
        be32(width) + be32(height) + static_cast<char>(bits) + static_cast<char>(colour_type) + std::string(3, '\0');
    return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) + extra + png_chunk("IDAT", packed) + png_chunk("IEND", "");
}

std::string tiff_file(unsigned width, unsigned height, unsigned bits, unsigned channels, unsigned photometric,
                      const std::string& pixels, const std::vector<TiffTag>& tags) {
    // The pixels stand behind the 8 bytes of the header, then the sizes of the channels, then the directory.
    std::string file = "II" + le16(42) + le32(0) + pixels;
    if (file.size() % 2 != 0) file += '\0';
    const unsigned bits_at = static_cast<unsigned>(file.size());
    for (unsigned i = 0; i < channels; ++i) file += le16(bits);
    const bool inside = channels <= 2;
    std::vector<std::string> entries = {
        le16(256) + le16(4) + le32(1) + le32(width),
        le16(257) + le16(4) + le32(1) + le32(height),
        le16(258) + le16(3) + le32(channels) + (inside ? le16(bits) + le16(channels == 2 ? bits : 0) : le32(bits_at)),
        le16(259) + le16(3) + le32(1) + le32(1),
        le16(262) + le16(3) + le32(1) + le32(photometric),
        le16(273) + le16(4) + le32(1) + le32(8),
        le16(277) + le16(3) + le32(1) + le32(channels),
        le16(278) + le16(4) + le32(1) + le32(height),
        le16(279) + le16(4) + le32(1) + le32(static_cast<unsigned>(pixels.size()))};
    for (const TiffTag& tag : tags) entries.push_back(le16(tag.tag) + le16(tag.type) + le32(1) + le32(tag.value));
    std::sort(entries.begin(), entries.end(), [](const std::string& a, const std::string& b) {
        const auto tag = [](const std::string& entry) {
            return static_cast<unsigned char>(entry[0]) | static_cast<unsigned char>(entry[1]) << 8;
        };
        return tag(a) < tag(b);
    });
    file.replace(4, 4, le32(static_cast<unsigned>(file.size())));
    file += le16(static_cast<unsigned>(entries.size()));
    for (const std::string& entry : entries) file += entry;
    return file + le32(0);
}

std::vector<std::uint8_t> exif_block(int orientation, bool little_endian) {
    const auto u16 = [&](unsigned value) { return little_endian ? le16(value) : be16(value); };
    const auto u32 = [&](unsigned value) { return little_endian ? le32(value) : be32(value); };
    const std::string make("Puppeteer\0", 10);
    const std::string note("\x01\x00\xff\xfenot for you", 15);
    const unsigned directory_end = 8 + 2 + 3 * 12 + 4;
    const unsigned exif_directory = directory_end + static_cast<unsigned>(make.size());
    std::string block = (little_endian ? "II" : "MM") + u16(42) + u32(8) + u16(3);
    block += u16(0x010f) + u16(2) + u32(10) + u32(directory_end);
    block += u16(0x0112) + u16(3) + u32(1) + u16(static_cast<unsigned>(orientation)) + u16(0);
    block += u16(0x8769) + u16(4) + u32(1) + u32(exif_directory);
    block += u32(0) + make;
    block +=
        u16(1) + u16(0x927c) + u16(7) + u32(static_cast<unsigned>(note.size())) + u32(exif_directory + 18) + u32(0);
    block += note;
    return {block.begin(), block.end()};
}

std::vector<std::uint8_t> icc_profile(const std::string& name) {
    start_vips();
    VipsBlob* blob = nullptr;
    if (vips_profile_load(name.c_str(), &blob, nullptr) != 0) vips_failed();
    std::size_t size = 0;
    const auto* bytes = static_cast<const std::uint8_t*>(vips_blob_get(blob, &size));
    std::vector<std::uint8_t> profile(bytes, bytes + size);
    vips_area_unref(VIPS_AREA(blob));
    return profile;
}

std::vector<std::uint8_t> grey_profile() {
    std::vector<std::uint8_t> profile = icc_profile("srgb");
    std::memcpy(profile.data() + 16, "GRAY", 4);
    return profile;
}

cv::Mat vips_pixels(const std::filesystem::path& path) {
    start_vips();
    VipsImage* image = vips_image_new_from_file(path.c_str(), nullptr);
    if (image == nullptr) vips_failed();
    const int depth = image->BandFmt == VIPS_FORMAT_UCHAR    ? CV_8U
                      : image->BandFmt == VIPS_FORMAT_USHORT ? CV_16U
                                                             : CV_32F;
    std::size_t size = 0;
    void* memory = vips_image_write_to_memory(image, &size);
    if (memory == nullptr) vips_failed();
    const cv::Mat pixels = cv::Mat(image->Ysize, image->Xsize, CV_MAKETYPE(depth, image->Bands), memory).clone();
    g_free(memory);
    g_object_unref(image);
    return pixels;
}

void vips_store(const cv::Mat& pixels, const std::string& path_with_options) {
    start_vips();
    const int depth = pixels.depth();
    VipsImage* image = vips_image_new_from_memory(pixels.data, pixels.total() * pixels.elemSize(), pixels.cols,
                                                  pixels.rows, pixels.channels(),
                                                  depth == CV_8U    ? VIPS_FORMAT_UCHAR
                                                  : depth == CV_16U ? VIPS_FORMAT_USHORT
                                                                    : VIPS_FORMAT_FLOAT);
    const bool grey = pixels.channels() <= 2;
    image->Type = depth == CV_16U ? (grey ? VIPS_INTERPRETATION_GREY16 : VIPS_INTERPRETATION_RGB16)
                                  : (grey ? VIPS_INTERPRETATION_B_W : VIPS_INTERPRETATION_sRGB);
    const int status = vips_image_write_to_file(image, path_with_options.c_str(), nullptr);
    g_object_unref(image);
    if (status != 0) vips_failed();
}

}  // namespace puppetwarp::test
