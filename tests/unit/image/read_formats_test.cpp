#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>

#include "test_pictures.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <cstring>

#include <vips/vips.h>

namespace puppetwarp {
namespace {

using test::noise;
using test::png_chunk;
using test::png_file;
using test::same;
using test::store;
using test::TemporaryFolder;
using test::tiff_file;

class ReadFormats : public testing::Test {
protected:
    // Through a file; the header's story must agree with the pixels.
    Image read(const std::string& name, const std::string& bytes) {
        store(folder / name, bytes);
        return read_stored(name);
    }
    Image read_stored(const std::string& name) {
        const Image image = read_image(folder / name);
        const ImageInfo info = read_image_info(folder / name);
        EXPECT_EQ(info.width, image.width());
        EXPECT_EQ(info.height, image.height());
        EXPECT_EQ(info.channels, image.pixels.channels());
        EXPECT_EQ(info.bits, static_cast<int>(image.pixels.elemSize1()) * 8);
        EXPECT_EQ(info.has_alpha, image.has_alpha());
        return image;
    }
    template <typename T>
    static std::vector<T> values(const Image& image) {
        const cv::Mat flat = image.pixels.isContinuous() ? image.pixels : image.pixels.clone();
        return {flat.ptr<T>(), flat.ptr<T>() + flat.total() * static_cast<std::size_t>(flat.channels())};
    }
    TemporaryFolder folder;
};

using Bytes = std::vector<std::uint8_t>;
using Words = std::vector<std::uint16_t>;

TEST_F(ReadFormats, OneBitGreyPngBecomesBlackAndWhite) {
    const Image image = read("a.png", png_file(4, 1, 1, 0, std::string("\0\xa0", 2)));
    ASSERT_EQ(image.pixels.type(), CV_8UC1);
    EXPECT_EQ(values<std::uint8_t>(image), (Bytes{255, 0, 255, 0}));
}

TEST_F(ReadFormats, TwoAndFourBitGreyPngSpreadOverTheWholeRange) {
    EXPECT_EQ(values<std::uint8_t>(read("a.png", png_file(4, 1, 2, 0, std::string("\0\x1b", 2)))),
              (Bytes{0, 85, 170, 255}));
    EXPECT_EQ(values<std::uint8_t>(read("a.png", png_file(2, 1, 4, 0, std::string("\0\x0f", 2)))), (Bytes{0, 255}));
    EXPECT_EQ(values<std::uint8_t>(read("a.png", png_file(2, 1, 4, 0, std::string("\0\x17", 2)))), (Bytes{17, 119}));
}

TEST_F(ReadFormats, PaletteBecomesRgb) {
    const std::string palette = png_chunk("PLTE", std::string("\x01\x02\x03\xff\x80\x40", 6));
    const Image image = read("a.png", png_file(2, 1, 8, 3, std::string("\0\1\0", 3), palette));
    ASSERT_EQ(image.pixels.type(), CV_8UC3);
    EXPECT_EQ(values<std::uint8_t>(image), (Bytes{255, 128, 64, 1, 2, 3}));
}

TEST_F(ReadFormats, PaletteWithTransparencyBecomesRgba) {
    const std::string extra = png_chunk("PLTE", std::string("\x01\x02\x03\xff\x80\x40", 6)) + png_chunk("tRNS", "\x37");
    const Image image = read("a.png", png_file(2, 1, 1, 3, std::string("\0\x40", 2), extra));
    ASSERT_EQ(image.pixels.type(), CV_8UC4);
    EXPECT_EQ(values<std::uint8_t>(image), (Bytes{1, 2, 3, 0x37, 255, 128, 64, 255}));
}

TEST_F(ReadFormats, SixteenBitPngWithATransparentColour) {
    const std::string row = std::string(1, '\0') + test::be16(1000) + test::be16(2000) + test::be16(3000) +
                            test::be16(1001) + test::be16(2000) + test::be16(3000);
    const std::string key = png_chunk("tRNS", test::be16(1000) + test::be16(2000) + test::be16(3000));
    const Image image = read("a.png", png_file(2, 1, 16, 2, row, key));
    ASSERT_EQ(image.pixels.type(), CV_16UC4);
    EXPECT_EQ(values<std::uint16_t>(image), (Words{1000, 2000, 3000, 0, 1001, 2000, 3000, 65535}));
}

TEST_F(ReadFormats, GreyPngWithATransparentGrey) {
    const Image image =
        read("a.png", png_file(2, 1, 8, 0, std::string("\0\x10\x20", 3), png_chunk("tRNS", test::be16(0x20))));
    ASSERT_EQ(image.pixels.type(), CV_8UC2);
    EXPECT_EQ(values<std::uint8_t>(image), (Bytes{0x10, 255, 0x20, 0}));
}

TEST_F(ReadFormats, GreyWithAlphaStaysTwoChannels) {
    const Image image = read("a.png", png_file(2, 1, 8, 4, std::string("\0\x10\x80\x20\x00", 5)));
    ASSERT_EQ(image.pixels.type(), CV_8UC2);
    EXPECT_EQ(values<std::uint8_t>(image), (Bytes{0x10, 0x80, 0x20, 0}));
}

TEST_F(ReadFormats, InterlacedPng) {
    const cv::Mat pixels = noise(37, 29, CV_8U, 4, 3);
    test::vips_store(pixels, (folder / "a.png").string() + "[interlace]");
    EXPECT_TRUE(same(read_stored("a.png").pixels, pixels));
}

TEST_F(ReadFormats, CmykBecomesSrgb) {
    // C, M, Y, K: none, full cyan, full black ink.
    const std::string ink("\0\0\0\0\xff\0\0\0\0\0\0\xff", 12);
    const Image image = read("a.tif", tiff_file(3, 1, 8, 4, 5, ink));
    ASSERT_EQ(image.pixels.type(), CV_8UC3);
    const Bytes v = values<std::uint8_t>(image);
    EXPECT_GT(std::min({v[0], v[1], v[2]}), 250);  // paper
    EXPECT_LT(v[3], 80);                           // cyan has no red
    EXPECT_GT(std::min(v[4], v[5]), 120);
    EXPECT_LT(std::max({v[6], v[7], v[8]}), 70);  // black
    EXPECT_TRUE(image.metadata.icc.empty());      // a profile of inks no longer fits
}

TEST_F(ReadFormats, CmykJpegGoesThroughItsOwnProfile) {
    VipsImage* ink = vips_image_new_from_memory_copy("\0\0\0\0\xff\0\0\0\0\0\0\xff", 12, 3, 1, 4, VIPS_FORMAT_UCHAR);
    ASSERT_NE(ink, nullptr);
    ink->Type = VIPS_INTERPRETATION_CMYK;
    const auto profile = test::icc_profile("cmyk");
    vips_image_set_blob_copy(ink, VIPS_META_ICC_NAME, profile.data(), profile.size());
    ASSERT_EQ(vips_jpegsave(ink, (folder / "a.jpg").c_str(), "Q", 100, nullptr), 0) << vips_error_buffer();
    g_object_unref(ink);
    const Image image = read_stored("a.jpg");
    ASSERT_EQ(image.pixels.type(), CV_8UC3);
    EXPECT_GT(values<std::uint8_t>(image)[0], 240);
    EXPECT_TRUE(image.metadata.icc.empty());
}

TEST_F(ReadFormats, LabBecomesSrgb) {
    // 8-bit CIELAB of TIFF: L of 255 is 100, a and b signed.
    const Image image = read("a.tif", tiff_file(2, 1, 8, 3, 8, std::string("\xff\0\0\0\0\0", 6)));
    ASSERT_EQ(image.pixels.channels(), 3);
    for (int c = 0; c < 3; ++c) {
        const double white =
            image.pixels.depth() == CV_8U ? image.pixels.ptr()[c] : image.pixels.ptr<std::uint16_t>()[c];
        const double black =
            image.pixels.depth() == CV_8U ? image.pixels.ptr()[3 + c] : image.pixels.ptr<std::uint16_t>()[3 + c];
        EXPECT_NEAR(white / image.full_value(), 1, 0.02);
        EXPECT_NEAR(black / image.full_value(), 0, 0.01);
    }
}

TEST_F(ReadFormats, OneBitTiff) {
    const Image image = read("a.tif", tiff_file(4, 1, 1, 1, 1, "\xa0"));
    ASSERT_EQ(image.pixels.type(), CV_8UC1);
    EXPECT_EQ(values<std::uint8_t>(image), (Bytes{255, 0, 255, 0}));
    EXPECT_EQ(values<std::uint8_t>(read("b.tif", tiff_file(4, 1, 1, 1, 0, "\xa0"))),
              (Bytes{0, 255, 0, 255}));  // white is 0
}

TEST_F(ReadFormats, TiffWithMultipliedAlphaBecomesStraight) {
    // 64 of 255 at alpha 128 of 255 is 127.5 straight.
    const Image image = read("a.tif", tiff_file(1, 1, 8, 4, 2, "\x40\x40\x40\x80", {{338, 3, 1}}));
    ASSERT_EQ(image.pixels.type(), CV_8UC4);
    EXPECT_NEAR(image.pixels.at<cv::Vec4b>(0, 0)[0], 127.5, 1);
    EXPECT_EQ(image.pixels.at<cv::Vec4b>(0, 0)[3], 128);
    const Image straight = read("b.tif", tiff_file(1, 1, 8, 4, 2, "\x40\x40\x40\x80", {{338, 3, 2}}));
    EXPECT_EQ(straight.pixels.at<cv::Vec4b>(0, 0), cv::Vec4b(64, 64, 64, 128));
}

TEST_F(ReadFormats, UnsignedThirtyTwoBitTiffBecomesFloat) {
    const Image image = read("a.tif", tiff_file(2, 1, 32, 1, 1, test::le32(0xffffffff) + test::le32(0x40000000)));
    ASSERT_EQ(image.pixels.type(), CV_32FC1);
    EXPECT_EQ(values<float>(image), (std::vector<float>{1, 0.25f}));
}

TEST_F(ReadFormats, PixmapsAreScaledByTheirOwnWhite) {
    EXPECT_EQ(values<std::uint8_t>(read("a.pgm", "P5 3 1 15\n" + std::string("\0\5\x0f", 3))), (Bytes{0, 85, 255}));
    EXPECT_EQ(values<std::uint8_t>(read("b.pgm", "P2 3 1 4\n0 1 4\n")), (Bytes{0, 64, 255}));
    const Image deep = read("c.pgm", "P5 3 1 1023\n" + test::be16(0) + test::be16(341) + test::be16(1023));
    ASSERT_EQ(deep.pixels.type(), CV_16UC1);
    EXPECT_EQ(values<std::uint16_t>(deep), (Words{0, 21845, 65535}));
    EXPECT_EQ(values<std::uint8_t>(read("d.pbm", "P4 4 1\n\x50")), (Bytes{255, 0, 255, 0}));
    EXPECT_EQ(values<std::uint8_t>(read("e.ppm", "P6 1 1 255\nabc")), (Bytes{'a', 'b', 'c'}));
}

TEST_F(ReadFormats, FloatMapsStandFromTheBottomUp) {
    const float rows[4] = {1, 2, 3, 4};  // bottom row first
    std::string bytes(sizeof rows, '\0');
    std::memcpy(bytes.data(), rows, sizeof rows);
    const Image image = read("a.pfm", "Pf\n2 2\n-1.0\n" + bytes);
    ASSERT_EQ(image.pixels.type(), CV_32FC1);
    EXPECT_EQ(values<float>(image), (std::vector<float>{3, 4, 1, 2}));
    EXPECT_EQ(read_image_info(folder / "a.pfm").format, "pfm");
}

TEST_F(ReadFormats, RadianceBecomesLinearFloat) {
    // One pixel, not run-length coded: mantissas 128, 64, 0, exponent 129: 1, 0.5, 0.
    const Image image = read("a.hdr", std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n") + "\x80\x40" +
                                          std::string("\0\x81", 2));
    ASSERT_EQ(image.pixels.type(), CV_32FC3);
    const auto v = values<float>(image);
    EXPECT_NEAR(v[0], 1, 0.01);
    EXPECT_NEAR(v[1], 0.5, 0.01);
    EXPECT_NEAR(v[2], 0, 0.01);
}

TEST_F(ReadFormats, OtherLosslessFormatsGiveTheSamePixels) {
    const cv::Mat pixels = noise(40, 30, CV_8U, 3, 8);
    for (const char* name : {"a.webp[lossless]", "a.jp2[lossless]", "a.tif[tile,compression=lzw]"}) {
        test::vips_store(pixels, (folder / name).string());
        const std::string plain = std::string(name).substr(0, std::string(name).find('['));
        EXPECT_TRUE(same(read_stored(plain).pixels, pixels)) << name;
    }
    test::vips_store(noise(40, 30, CV_16U, 3, 8), (folder / "b.jp2[lossless]").string());
    EXPECT_TRUE(same(read_stored("b.jp2").pixels, noise(40, 30, CV_16U, 3, 8)));
}

TEST_F(ReadFormats, PhonePicturesAreRead) {
    const cv::Mat flat(64, 64, CV_8UC3, cv::Scalar(200, 100, 50));
    for (const char* name : {"a.heic", "a.avif"}) {
        test::vips_store(flat, (folder / name).string());
        const Image image = read_stored(name);
        ASSERT_EQ(image.pixels.size(), flat.size()) << name;
        EXPECT_LE(cv::norm(image.pixels, flat, cv::NORM_INF), 4) << name;
        EXPECT_EQ(read_image_info(folder / name).format, "heif");
    }
}

TEST_F(ReadFormats, OfSeveralPagesTheFirst) {
    VipsImage* tall = vips_image_new_from_memory_copy("\x10\x20\x30\x40", 4, 2, 2, 1, VIPS_FORMAT_UCHAR);
    vips_image_set_int(tall, VIPS_META_PAGE_HEIGHT, 1);
    ASSERT_EQ(vips_tiffsave(tall, (folder / "a.tif").c_str(), nullptr), 0) << vips_error_buffer();
    g_object_unref(tall);
    EXPECT_EQ(values<std::uint8_t>(read_stored("a.tif")), (Bytes{0x10, 0x20}));
    EXPECT_EQ(read_image_info(folder / "a.tif").pages, 2);
}

TEST_F(ReadFormats, InfoNamesTheFormat) {
    const cv::Mat pixels = noise(8, 8, CV_8U, 3, 8);
    for (const auto& [file, format] : std::vector<std::pair<std::string, std::string>>{{"a.png", "png"},
                                                                                       {"a.jpg", "jpeg"},
                                                                                       {"a.tif", "tiff"},
                                                                                       {"a.webp", "webp"},
                                                                                       {"a.gif", "gif"},
                                                                                       {"a.ppm", "ppm"},
                                                                                       {"a.jp2", "jpeg2000"}}) {
        test::vips_store(pixels, (folder / file).string());
        EXPECT_EQ(read_image_info(folder / file).format, format);
        std::filesystem::rename(folder / file, folder / "no_extension");  // the content counts, not the name
        EXPECT_EQ(read_image_info(folder / "no_extension").format, format);
    }
}

}  // namespace
}  // namespace puppetwarp
