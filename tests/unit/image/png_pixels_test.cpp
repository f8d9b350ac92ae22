// The quick way through a plain PNG, beside libpng's, and all that must not go that way.

#include <puppetwarp/image/png_pixels.h>
#include <puppetwarp/image/read.h>

#include "test_pictures.h"

#include <gtest/gtest.h>

#include <vips/vips.h>

#include <cstring>
#include <random>

namespace puppetwarp {
namespace {

using test::png_chunk;
using test::png_file;
using test::store;
using test::TemporaryFolder;

constexpr int kColourTypes[]{0, 4, 2, 6};

// Random bytes under random filters: every one of them is a picture.
std::string random_rows(int width, int height, int pixel_bytes, std::mt19937& random) {
    std::string rows;
    for (int y = 0; y < height; ++y) {
        rows += static_cast<char>(random() % 5);
        for (int i = 0; i < width * pixel_bytes; ++i) rows += static_cast<char>(random());
    }
    return rows;
}

cv::Mat plain(const std::string& path, int width, int height, int type) {
    return plain_png_pixels(PictureFile(path), width, height, type);
}

// As libpng reads it, through libvips.
std::string pixels_of_libpng(const std::string& path) {
    VipsImage* image = vips_image_new_from_file(path.c_str(), nullptr);
    if (image == nullptr) return "unreadable";
    std::size_t size = 0;
    void* memory = vips_image_write_to_memory(image, &size);
    const std::string bytes(static_cast<const char*>(memory), size);
    g_free(memory);
    g_object_unref(image);
    return bytes;
}

TEST(PngPixels, AreThoseOfLibpngUnderEveryFilterInEveryKind) {
    const TemporaryFolder folder;
    read_image_info(PUPPETWARP_SOURCE_DIR "/images/ring.png");  // starts libvips
    std::mt19937 random(1);
    for (const int bits : {8, 16}) {
        for (int channels = 1; channels <= 4; ++channels) {
            for (const auto& [width, height] : {std::pair{1, 1}, {1, 40}, {57, 3}, {64, 90}}) {
                const std::string rows = random_rows(width, height, channels * bits / 8, random);
                store(folder / "a.png", png_file(static_cast<unsigned>(width), static_cast<unsigned>(height), bits,
                                                 kColourTypes[channels - 1], rows));
                const int type = CV_MAKETYPE(bits == 8 ? CV_8U : CV_16U, channels);
                const cv::Mat pixels = plain(folder / "a.png", width, height, type);
                ASSERT_FALSE(pixels.empty());
                ASSERT_EQ(pixels.type(), type);
                ASSERT_TRUE(pixels.isContinuous());
                ASSERT_EQ(pixels.size(), cv::Size(width, height));
                const std::string expected = pixels_of_libpng(folder / "a.png");
                ASSERT_EQ(expected.size(), pixels.total() * pixels.elemSize());
                ASSERT_EQ(std::memcmp(expected.data(), pixels.data, expected.size()), 0)
                    << bits << " bits, " << channels << " channels, " << width << " x " << height;
                EXPECT_TRUE(test::same(read_image(folder / "a.png").pixels, pixels));
            }
        }
    }
}

TEST(PngPixels, WhatIsNotPlainIsLeftToLibvips) {
    const TemporaryFolder folder;
    std::mt19937 random(2);
    const std::string rows = random_rows(9, 7, 3, random);
    const std::string whole = png_file(9, 7, 8, 2, rows);
    const auto left = [&](const std::string& bytes, int width = 9, int height = 7, int type = CV_8UC3) {
        store(folder / "a.png", bytes);
        return plain(folder / "a.png", width, height, type).empty();
    };
    EXPECT_FALSE(left(whole));
    EXPECT_FALSE(left(png_file(9, 7, 8, 2, rows, png_chunk("tEXt", std::string("a\0b", 3)))));
    EXPECT_TRUE(left(png_file(9, 7, 8, 2, rows, png_chunk("tRNS", std::string(6, '\0')))));
    EXPECT_TRUE(left(whole, 9, 8));
    EXPECT_TRUE(left(whole, 9, 7, CV_8UC4));
    EXPECT_TRUE(left(whole, 9, 7, CV_16UC3));
    std::string interlaced = whole;
    interlaced[28] = 1;  // its checksum is wrong, too
    EXPECT_TRUE(left(interlaced));
    std::string filter = rows;
    filter[0] = 5;
    EXPECT_TRUE(left(png_file(9, 7, 8, 2, filter)));
    EXPECT_TRUE(left(png_file(9, 7, 8, 2, rows.substr(0, rows.size() - 1))));
    EXPECT_TRUE(left(png_file(9, 7, 8, 2, rows + "x")));
    for (std::size_t cut = 1; cut < whole.size(); ++cut) EXPECT_TRUE(left(whole.substr(0, cut))) << cut;
    // One wrong bit anywhere is seen by a checksum, in the signature, or in a length.
    for (std::size_t at = 0; at < whole.size(); ++at) {
        std::string flipped = whole;
        flipped[at] = static_cast<char>(flipped[at] ^ 1 << at % 8);
        EXPECT_TRUE(left(flipped)) << at;
    }
}

TEST(PngPixels, SeveralPiecesInARowAreOneAndTornApartAreNone) {
    const TemporaryFolder folder;
    std::mt19937 random(3);
    const std::string rows = random_rows(30, 20, 3, random);
    const std::string whole = png_file(30, 20, 8, 2, rows);
    const std::size_t pixels_at = whole.find("IDAT") - 4;
    const auto length = static_cast<std::size_t>(static_cast<unsigned char>(whole[pixels_at + 2])) * 256 +
                        static_cast<unsigned char>(whole[pixels_at + 3]);
    const std::string body = whole.substr(pixels_at + 8, length), head = whole.substr(0, pixels_at),
                      tail = whole.substr(pixels_at + 12 + length);
    const std::string first = png_chunk("IDAT", body.substr(0, 100)), none = png_chunk("IDAT", ""),
                      rest = png_chunk("IDAT", body.substr(100));
    store(folder / "whole.png", whole);
    store(folder / "pieces.png", head + none + first + none + rest + none + tail);
    store(folder / "torn.png", head + first + png_chunk("tEXt", std::string("a\0b", 3)) + rest + tail);
    const cv::Mat expected = plain(folder / "whole.png", 30, 20, CV_8UC3);
    ASSERT_FALSE(expected.empty());
    EXPECT_TRUE(test::same(plain(folder / "pieces.png", 30, 20, CV_8UC3), expected));
    EXPECT_TRUE(plain(folder / "torn.png", 30, 20, CV_8UC3).empty());
}

}  // namespace
}  // namespace puppetwarp
