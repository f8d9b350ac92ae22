// The PNG writer, read by libpng (through libvips alone).
#include <puppetwarp/image/write.h>

#include "test_pictures.h"

#include <gtest/gtest.h>

namespace puppetwarp {
namespace {

using test::file_bytes;
using test::noise;
using test::same;
using test::TemporaryFolder;
using test::vips_pixels;

// Soft gradients, flat areas and noise, so that every row filter is chosen somewhere.
cv::Mat varied(int width, int height, int depth, int channels) {
    cv::Mat pixels = noise(width, height, depth, channels, 4);
    const int values = width * channels;
    for (int y = 0; y < height; ++y) {
        for (int i = 0; i < values; ++i) {
            const int value = (y / 7) % 5 == 0   ? i / channels
                              : (y / 7) % 5 == 1 ? y * 3
                              : (y / 7) % 5 == 2 ? 9
                                                 : y + i / channels;
            if ((y / 7) % 5 == 4) continue;
            if (depth == CV_8U) pixels.ptr<std::uint8_t>(y)[i] = static_cast<std::uint8_t>(value);
            if (depth == CV_16U) pixels.ptr<std::uint16_t>(y)[i] = static_cast<std::uint16_t>(value * 200);
        }
    }
    return pixels;
}

TEST(PngWriter, IsReadBitForBitByLibpngInEveryLayoutAndLevel) {
    const TemporaryFolder folder;
    for (const int depth : {CV_8U, CV_16U}) {
        for (int channels = 1; channels <= 4; ++channels) {
            for (int compression = 0; compression <= 9; ++compression) {
                const cv::Mat pixels = varied(133, 97, depth, channels);
                write_image({pixels, {}}, folder / "a.png", {.compression = compression});
                EXPECT_TRUE(same(vips_pixels(folder / "a.png"), pixels))
                    << depth << " " << channels << " " << compression;
            }
        }
    }
}

TEST(PngWriter, JoinsItsBandsOnAnyRow) {
    const TemporaryFolder folder;
    // A band is 1 MB: heights around one and two bands of rows of 4001 bytes, and rows longer than a band.
    for (const int height : {261, 262, 263, 524, 525, 1100}) {
        const cv::Mat pixels = varied(1000, height, CV_8U, 4);
        write_image({pixels, {}}, folder / "a.png");
        EXPECT_TRUE(same(vips_pixels(folder / "a.png"), pixels)) << height;
    }
    const cv::Mat wide = varied(400'000, 3, CV_8U, 4);
    write_image({wide, {}}, folder / "a.png");
    EXPECT_TRUE(same(vips_pixels(folder / "a.png"), wide));
}

TEST(PngWriter, SmallerAtHigherLevels) {
    const TemporaryFolder folder;
    const cv::Mat pixels = varied(400, 400, CV_8U, 3);
    std::size_t sizes[3];
    for (int i = 0; i < 3; ++i) {
        write_image({pixels, {}}, folder / "a.png", {.compression = i == 0 ? 0 : i == 1 ? 1 : 9});
        sizes[i] = file_bytes(folder / "a.png").size();
    }
    EXPECT_GT(sizes[0], 400u * 400 * 3);
    EXPECT_LT(sizes[1], sizes[0] / 2);
    EXPECT_LT(sizes[2], sizes[1]);
}

// PNG 3rd edition, section 5.6: what must stand before what.
TEST(PngWriter, OrdersItsChunksAsTheStandardAsks) {
    const TemporaryFolder folder;
    Image image{varied(20, 20, CV_8U, 3), {}};
    image.metadata.icc = test::icc_profile("srgb");
    image.metadata.exif = test::exif_block(1);
    image.metadata.xmp = {'<', 'x', '/', '>'};
    image.metadata.x_pixels_per_mm = image.metadata.y_pixels_per_mm = 4;
    write_image(image, folder / "a.png");
    const std::string bytes = file_bytes(folder / "a.png");
    std::vector<std::string> names;
    for (std::size_t at = 8; at + 8 <= bytes.size();) {
        std::size_t length = 0;
        for (int i = 0; i < 4; ++i)
            length = length << 8 | static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(i)]);
        names.push_back(bytes.substr(at + 4, 4));
        // Every chunk made again by the test's own means, its checksum included.
        EXPECT_EQ(test::png_chunk(names.back(), bytes.substr(at + 8, length)), bytes.substr(at, length + 12))
            << names.back();
        at += length + 12;
    }
    EXPECT_EQ(names, (std::vector<std::string>{"IHDR", "iCCP", "pHYs", "eXIf", "iTXt", "IDAT", "IEND"}));
}

}  // namespace
}  // namespace puppetwarp
