#pragma once

#include <puppetwarp/base/image.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace puppetwarp::test {

//! A folder of its own for one test, gone with the object.
class TemporaryFolder {
public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

//! Seeded noise; integers over their whole range, floats in [0, 1).
cv::Mat noise(int width, int height, int depth, int channels, unsigned seed);

//! Same size, type and bytes.
bool same(const cv::Mat& a, const cv::Mat& b);

std::string file_bytes(const std::filesystem::path& path);
void store(const std::filesystem::path& path, const std::string& bytes);

std::string be16(unsigned value);
std::string be32(unsigned value);
std::string le16(unsigned value);
std::string le32(unsigned value);

//! One PNG chunk: length, name, body, CRC.
std::string png_chunk(const std::string& name, const std::string& body);
//! A PNG made by hand. \param rows  filtered rows, not packed. \param extra  chunks between IHDR and IDAT.
std::string png_file(unsigned width, unsigned height, int bits, int colour_type, const std::string& rows,
                     const std::string& extra = {});

//! A classic little-endian TIFF of one strip, made by hand. `tags` are further entries {tag, type, value}, values of
//! one SHORT or LONG.
struct TiffTag {
    unsigned tag, type, value;
};
std::string tiff_file(unsigned width, unsigned height, unsigned bits, unsigned channels, unsigned photometric,
                      const std::string& pixels, const std::vector<TiffTag>& tags = {});

//! A minimal EXIF block (TIFF header on): orientation, a maker's text, and a maker note of bytes that nobody
//! understands.
std::vector<std::uint8_t> exif_block(int orientation, bool little_endian = true);

//! An ICC profile (of libvips, `srgb`, `cmyk` or `p3`).
std::vector<std::uint8_t> icc_profile(const std::string& name);
//! A profile's bytes whose header says that it is of grey.
std::vector<std::uint8_t> grey_profile();

//! What libvips alone, without puppetwarp, reads: for 8-bit, 16-bit and float pictures.
cv::Mat vips_pixels(const std::filesystem::path& path);
//! Writes through libvips alone, in the format of the path's extension with libvips' own options ("[lossless]").
void vips_store(const cv::Mat& pixels, const std::string& path_with_options);

//! The message of the InvalidInput that a call throws; "" when it throws none.
template <typename Call>
std::string refusal(const Call& call);

}  // namespace puppetwarp::test

#include <puppetwarp/base/errors.h>

template <typename Call>
std::string puppetwarp::test::refusal(const Call& call) {
    try {
        call();
        return "";
    } catch (const InvalidInput& error) {
        return error.what();
    }
}
