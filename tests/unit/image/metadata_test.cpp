#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>

#include "test_pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vips/vips.h>

namespace puppetwarp {
namespace {

using test::exif_block;
using test::file_bytes;
using test::noise;
using test::same;
using test::store;
using test::TemporaryFolder;

// The upright picture by the table of EXIF 2.32: which stored pixel stands at (x, y).
cv::Mat turned(const cv::Mat& stored, int orientation) {
    const int w = stored.cols;
    const int h = stored.rows;
    const bool swap = orientation >= 5;
    cv::Mat result(swap ? w : h, swap ? h : w, stored.type());
    for (int y = 0; y < result.rows; ++y) {
        for (int x = 0; x < result.cols; ++x) {
            int row = y;
            int column = x;
            switch (orientation) {
                case 2: column = w - 1 - x; break;                   // row 0 top, column 0 right
                case 3: row = h - 1 - y, column = w - 1 - x; break;  // bottom, right
                case 4: row = h - 1 - y; break;                      // bottom, left
                case 5: row = x, column = y; break;                  // left, top
                case 6: row = h - 1 - x, column = y; break;          // right, top
                case 7: row = h - 1 - x, column = w - 1 - y; break;  // right, bottom
                case 8: row = x, column = w - 1 - y; break;          // left, bottom
                default: break;
            }
            std::copy_n(stored.ptr(row) + static_cast<std::size_t>(column) * stored.elemSize(), stored.elemSize(),
                        result.ptr(y) + static_cast<std::size_t>(x) * result.elemSize());
        }
    }
    return result;
}

std::string png_with_exif(const cv::Mat& grey, const std::vector<std::uint8_t>& exif) {
    std::string rows;
    for (int y = 0; y < grey.rows; ++y)
        rows += '\0' + std::string(grey.ptr<char>(y), static_cast<std::size_t>(grey.cols));
    return test::png_file(static_cast<unsigned>(grey.cols), static_cast<unsigned>(grey.rows), 8, 0, rows,
                          test::png_chunk("eXIf", {exif.begin(), exif.end()}));
}

TEST(Orientation, OfExifIsAppliedToThePixelsAndThenSetToOne) {
    const TemporaryFolder folder;
    const cv::Mat stored = noise(7, 4, CV_8U, 1, 2);
    for (int orientation = 1; orientation <= 8; ++orientation) {
        for (const bool little : {true, false}) {
            SCOPED_TRACE(orientation);
            store(folder / "a.png", png_with_exif(stored, exif_block(orientation, little)));
            const Image image = read_image(folder / "a.png");
            EXPECT_TRUE(same(image.pixels, turned(stored, orientation)));
            EXPECT_EQ(image.metadata.exif, exif_block(1, little));
            const ImageInfo info = read_image_info(folder / "a.png");
            EXPECT_EQ(info.orientation, orientation);
            EXPECT_EQ(info.width, image.width());
            EXPECT_EQ(info.height, image.height());
        }
    }
}

TEST(Orientation, IsAppliedOnceNotAgainByTheNextReader) {
    const TemporaryFolder folder;
    const cv::Mat stored = noise(7, 4, CV_8U, 3, 2);
    Image image{stored, {}};
    image.metadata.exif = exif_block(6);
    for (const char* name : {"a.png", "a.webp", "a.jpg"}) {
        write_image(image, folder / name);  // as a camera would: not upright, and says so
        const Image once = read_image(folder / name);
        EXPECT_EQ(once.width(), 4) << name;
        EXPECT_EQ(once.metadata.exif, exif_block(1)) << name;
        write_image(once, folder / name);
        const Image twice = read_image(folder / name);
        EXPECT_EQ(twice.width(), 4) << name;
        if (std::string(name) != "a.jpg") {
            EXPECT_TRUE(same(once.pixels, turned(stored, 6))) << name;
            EXPECT_TRUE(same(twice.pixels, once.pixels)) << name;
        }
    }
}

TEST(Orientation, OfATiffIsAppliedForEveryDepth) {
    const TemporaryFolder folder;
    for (unsigned orientation = 1; orientation <= 8; ++orientation) {
        const cv::Mat stored = noise(5, 3, CV_8U, 3, 2);
        store(folder / "a.tif",
              test::tiff_file(5, 3, 8, 3, 2, std::string(stored.ptr<char>(), 45), {{274, 3, orientation}}));
        EXPECT_TRUE(same(read_image(folder / "a.tif").pixels, turned(stored, static_cast<int>(orientation))))
            << orientation;
        const cv::Mat deep = noise(5, 3, CV_16U, 1, 2);
        store(folder / "b.tif",
              test::tiff_file(5, 3, 16, 1, 1, std::string(deep.ptr<char>(), 30), {{274, 3, orientation}}));
        EXPECT_TRUE(same(read_image(folder / "b.tif").pixels, turned(deep, static_cast<int>(orientation))))
            << orientation;
    }
}

TEST(Orientation, ATurnedPictureHasItsResolutionTurnedToo) {
    const TemporaryFolder folder;
    Image image{noise(4, 4, CV_8U, 1, 1), {}};
    image.metadata.exif = exif_block(6);
    image.metadata.x_pixels_per_mm = 2;
    image.metadata.y_pixels_per_mm = 5;
    write_image(image, folder / "a.png");
    EXPECT_DOUBLE_EQ(read_image(folder / "a.png").metadata.x_pixels_per_mm, 5);
    EXPECT_DOUBLE_EQ(read_image_info(folder / "a.png").y_pixels_per_mm, 2);
}

// Damaged EXIF blocks must neither crash nor lose the picture.
TEST(Orientation, NonsenseInExifIsNoOrientation) {
    const TemporaryFolder folder;
    const cv::Mat stored = noise(7, 4, CV_8U, 1, 2);
    const std::vector<std::uint8_t> whole = exif_block(6);
    for (std::size_t size = 0; size < whole.size(); ++size) {
        store(folder / "a.png",
              png_with_exif(stored, {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)}));
        EXPECT_NO_THROW(read_image(folder / "a.png")) << size;
    }
    for (const int orientation : {0, 9, 255, 65535}) {
        store(folder / "a.png", png_with_exif(stored, exif_block(orientation)));
        EXPECT_TRUE(same(read_image(folder / "a.png").pixels, stored)) << orientation;
    }
}

TEST(Metadata, ComesBackByteForByte) {
    const TemporaryFolder folder;
    Image image{noise(20, 10, CV_8U, 3, 1), {}};
    image.metadata.icc = test::icc_profile("p3");
    image.metadata.exif = exif_block(1);  // with a maker note, which libraries that take EXIF apart like to drop
    const std::string xmp = "<x:xmpmeta xmlns:x='adobe:ns:meta/'>\xc3\xa9</x:xmpmeta>";
    image.metadata.xmp.assign(xmp.begin(), xmp.end());
    for (const char* name : {"a.png", "a.jpg", "a.webp", "a.tif"}) {
        write_image(image, folder / name);
        const ImageMetadata back = read_image(folder / name).metadata;
        EXPECT_EQ(back.icc, image.metadata.icc) << name;
        EXPECT_EQ(back.xmp, image.metadata.xmp) << name;
        if (std::string(name) != "a.tif") {
            EXPECT_EQ(back.exif, image.metadata.exif) << name;
        }
        const ImageInfo info = read_image_info(folder / name);
        EXPECT_TRUE(info.has_icc && info.has_xmp) << name;
    }
}

TEST(Metadata, IsFoundByAnotherReader) {
    const TemporaryFolder folder;
    Image image{noise(20, 10, CV_8U, 3, 1), {}};
    image.metadata.icc = test::icc_profile("p3");
    image.metadata.exif = exif_block(1);
    image.metadata.xmp = {'<', 'x', '/', '>'};
    image.metadata.x_pixels_per_mm = image.metadata.y_pixels_per_mm = 300 / 25.4;
    for (const char* name : {"a.png", "a.jpg", "a.webp"}) {
        write_image(image, folder / name);
        VipsImage* read = vips_image_new_from_file((folder / name).c_str(), nullptr);
        ASSERT_NE(read, nullptr) << name << vips_error_buffer();
        const char* make = nullptr;
        EXPECT_EQ(vips_image_get_string(read, "exif-ifd0-Make", &make), 0) << name;
        EXPECT_THAT(make, testing::StartsWith("Puppeteer")) << name;
        EXPECT_NE(vips_image_get_typeof(read, VIPS_META_ICC_NAME), 0u) << name;
        EXPECT_NE(vips_image_get_typeof(read, VIPS_META_XMP_NAME), 0u) << name;
        g_object_unref(read);
    }
}

TEST(Metadata, AProfileLongerThanAJpegSegmentComesBack) {
    const TemporaryFolder folder;
    Image image{noise(8, 8, CV_8U, 3, 1), {}};
    image.metadata.icc = test::icc_profile("srgb");
    for (std::size_t i = 0; image.metadata.icc.size() < 200'000; ++i) {
        image.metadata.icc.push_back(static_cast<std::uint8_t>(i * i / 7));
    }
    // The size that a profile says of itself, ICC.1 7.2.2.
    for (int i = 0; i < 4; ++i)
        image.metadata.icc[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(200'000 >> (24 - 8 * i));
    write_image(image, folder / "a.jpg");
    EXPECT_EQ(read_image(folder / "a.jpg").metadata.icc, image.metadata.icc);
}

TEST(Metadata, ResolutionComesBack) {
    const TemporaryFolder folder;
    for (const double x_dpi : {72.0, 300.0, 25.4, 1200.0}) {
        Image image{noise(8, 8, CV_8U, 3, 1), {}};
        image.metadata.x_pixels_per_mm = x_dpi / 25.4;
        image.metadata.y_pixels_per_mm = 2 * x_dpi / 25.4;
        for (const char* name : {"a.png", "a.jpg", "a.tif", "a.exr"}) {
            write_image(image, folder / name);
            const ImageMetadata back = read_image(folder / name).metadata;
            // PNG counts whole pixels a metre, JPEG whole pixels an inch or a centimetre.
            EXPECT_NEAR(back.x_pixels_per_mm, image.metadata.x_pixels_per_mm, 0.0006) << name << x_dpi;
            EXPECT_NEAR(back.y_pixels_per_mm, image.metadata.y_pixels_per_mm, 0.0006) << name << x_dpi;
        }
    }
}

TEST(Metadata, WhatIsUnknownStaysUnknown) {
    const TemporaryFolder folder;
    for (const char* name : {"a.png", "a.jpg", "a.tif", "a.webp", "a.exr", "a.ppm"}) {
        write_image({noise(8, 8, CV_8U, 3, 1), {}}, folder / name);
        const ImageMetadata back = read_image(folder / name).metadata;
        EXPECT_TRUE(back.icc.empty()) << name;
        EXPECT_TRUE(back.exif.empty()) << name;
        EXPECT_TRUE(back.xmp.empty()) << name;
        EXPECT_EQ(back.x_pixels_per_mm, 0) << name;
        EXPECT_EQ(back.y_pixels_per_mm, 0) << name;
    }
}

TEST(Metadata, AFileHoldsNoTimeStamp) {
    const TemporaryFolder folder;
    Image image{noise(8, 8, CV_8U, 3, 1), {}};
    image.metadata.exif = exif_block(1);
    for (const char* name : {"a.png", "a.jpg", "a.tif", "a.webp", "a.exr"}) {
        write_image(image, folder / name);
        const std::string bytes = file_bytes(folder / name);
        EXPECT_EQ(bytes.find("tIME"), std::string::npos) << name;
        EXPECT_EQ(bytes.find("capDate"), std::string::npos) << name;
        if (std::string(name) == "a.tif") {
            EXPECT_EQ(bytes.find(test::le16(306) + test::le16(2)), std::string::npos);
        }
    }
}

}  // namespace
}  // namespace puppetwarp
