#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>

#include "test_pictures.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <cmath>
#include <cstring>

namespace puppetwarp {
namespace {

using test::noise;
using test::same;
using test::TemporaryFolder;

struct Held {
    const char* extension;
    int depth;
    int channels;
};

std::string held_name(const testing::TestParamInfo<Held>& info) {
    const char* depth = info.param.depth == CV_8U ? "8" : info.param.depth == CV_16U ? "16" : "float";
    return std::string(info.param.extension) + "_" + depth + "_bits_" + std::to_string(info.param.channels) +
           "_channels";
}

class LosslessFormat : public testing::TestWithParam<Held> {};

TEST_P(LosslessFormat, GivesBackEveryBit) {
    const TemporaryFolder folder;
    for (const int compression : {0, 1, 6, 9}) {
        for (const cv::Size size : {cv::Size(1, 1), cv::Size(3, 1), cv::Size(67, 41)}) {
            const auto path = folder / (std::string("a.") + GetParam().extension);
            const Image image{noise(size.width, size.height, GetParam().depth, GetParam().channels, 5), {}};
            ASSERT_TRUE(lost_in_format(image, output_format(path)).empty());
            write_image(image, path, {.compression = compression});
            EXPECT_TRUE(same(read_image(path).pixels, image.pixels)) << size << " at compression " << compression;
            const ImageInfo info = read_image_info(path);
            EXPECT_EQ(info.width, size.width);
            EXPECT_EQ(info.height, size.height);
            EXPECT_EQ(info.channels, GetParam().channels);
            EXPECT_EQ(info.has_alpha, GetParam().channels % 2 == 0);
            EXPECT_EQ(info.bits, GetParam().depth == CV_8U ? 8 : GetParam().depth == CV_16U ? 16 : 32);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(All, LosslessFormat,
                         testing::Values(Held{"png", CV_8U, 1}, Held{"png", CV_8U, 2}, Held{"png", CV_8U, 3},
                                         Held{"png", CV_8U, 4}, Held{"png", CV_16U, 1}, Held{"png", CV_16U, 2},
                                         Held{"png", CV_16U, 3}, Held{"png", CV_16U, 4}, Held{"tiff", CV_8U, 1},
                                         Held{"tiff", CV_8U, 2}, Held{"tiff", CV_8U, 3}, Held{"tiff", CV_8U, 4},
                                         Held{"tiff", CV_16U, 1}, Held{"tiff", CV_16U, 2}, Held{"tiff", CV_16U, 3},
                                         Held{"tiff", CV_16U, 4}, Held{"tiff", CV_32F, 1}, Held{"tiff", CV_32F, 2},
                                         Held{"tiff", CV_32F, 3}, Held{"tiff", CV_32F, 4}, Held{"webp", CV_8U, 3},
                                         Held{"exr", CV_32F, 1}, Held{"exr", CV_32F, 3}, Held{"ppm", CV_8U, 3},
                                         Held{"ppm", CV_16U, 3}, Held{"pgm", CV_8U, 1}, Held{"pgm", CV_16U, 1},
                                         Held{"pnm", CV_8U, 1}, Held{"pnm", CV_8U, 3}, Held{"pnm", CV_16U, 1},
                                         Held{"pnm", CV_16U, 3}, Held{"pfm", CV_32F, 1}, Held{"pfm", CV_32F, 3}),
                         held_name);

// A picture handed over as a view into a larger one, and in many bands of the PNG writer.
TEST(RoundTrip, AViewIntoALargerPictureIsWrittenAsItself) {
    const TemporaryFolder folder;
    for (const char* name : {"a.png", "a.tif", "a.webp", "a.ppm"}) {
        const cv::Mat large = noise(90, 70, CV_8U, 3, 1);
        const Image image{large(cv::Rect(7, 5, 60, 40)), {}};
        write_image(image, folder / name);
        EXPECT_TRUE(same(read_image(folder / name).pixels, image.pixels)) << name;
    }
}

TEST(RoundTrip, WebPKeepsColourWhereAlphaIsNotZero) {
    const TemporaryFolder folder;
    const Image image{noise(50, 40, CV_8U, 4, 3), {}};
    write_image(image, folder / "a.webp");
    const cv::Mat back = read_image(folder / "a.webp").pixels;
    ASSERT_EQ(back.type(), CV_8UC4);
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 50; ++x) {
            const auto& expected = image.pixels.at<cv::Vec4b>(y, x);
            const auto& actual = back.at<cv::Vec4b>(y, x);
            ASSERT_EQ(actual[3], expected[3]);
            if (expected[3] > 0) {
                ASSERT_EQ(actual, expected);
            }
        }
    }
}

TEST(RoundTrip, WebPStoresGreyAsThreeEqualChannels) {
    const TemporaryFolder folder;
    const Image image{noise(20, 10, CV_8U, 1, 3), {}};
    write_image(image, folder / "a.webp");
    const cv::Mat back = read_image(folder / "a.webp").pixels;
    ASSERT_EQ(back.type(), CV_8UC3);
    for (int y = 0; y < 10; ++y) {
        for (int x = 0; x < 20; ++x) {
            const auto v = image.pixels.at<std::uint8_t>(y, x);
            EXPECT_EQ(back.at<cv::Vec3b>(y, x), cv::Vec3b(v, v, v));
        }
    }
}

// EXR holds colour multiplied by alpha: exact where alpha is 0 or 1, else to a rounding of the product and the
// quotient.
TEST(RoundTrip, ExrKeepsStraightColourThroughItsMultipliedAlpha) {
    const TemporaryFolder folder;
    for (const int channels : {2, 4}) {
        Image image{noise(30, 20, CV_32F, channels, 9), {}};
        for (int y = 0; y < 5; ++y) {
            for (int x = 0; x < 30; ++x) image.pixels.ptr<float>(y)[x * channels + channels - 1] = 1;
        }
        write_image(image, folder / "a.exr");
        const cv::Mat back = read_image(folder / "a.exr").pixels;
        ASSERT_EQ(back.type(), image.pixels.type());
        for (int y = 0; y < 20; ++y) {
            for (int i = 0; i < 30 * channels; ++i) {
                const float expected = image.pixels.ptr<float>(y)[i];
                ASSERT_NEAR(back.ptr<float>(y)[i], expected, y < 5 ? 0.0 : 2.5e-7 * expected);
            }
        }
    }
}

TEST(RoundTrip, FloatsBeyondWhiteAndBelowBlackSurvive) {
    const TemporaryFolder folder;
    Image image{cv::Mat(1, 4, CV_32FC3), {}};
    const float values[12] = {-2, 0, 1, 1.5f, 100, 65504, 1e-8f, 3e38f, -0.0f, 0.25f, 7, 1e-30f};
    std::memcpy(image.pixels.data, values, sizeof values);
    for (const char* name : {"a.exr", "a.tif", "a.pfm"}) {
        write_image(image, folder / name);
        EXPECT_TRUE(same(read_image(folder / name).pixels, image.pixels)) << name;
    }
}

TEST(RoundTrip, JpegComesCloseAndKeepsColourEdgesSharp) {
    const TemporaryFolder folder;
    // Red and blue columns, one pixel wide: with halved chroma they would blend to purple.
    Image image{cv::Mat(32, 32, CV_8UC3), {}};
    for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 32; ++x) {
            image.pixels.at<cv::Vec3b>(y, x) = x % 2 == 0 ? cv::Vec3b(200, 60, 60) : cv::Vec3b(60, 60, 200);
        }
    }
    const auto largest_error = [&](int quality) {
        write_image(image, folder / "a.jpg", {.quality = quality});
        return cv::norm(read_image(folder / "a.jpg").pixels, image.pixels, cv::NORM_INF);
    };
    EXPECT_LT(largest_error(95), 12);
    EXPECT_LT(largest_error(90), 20);
    EXPECT_GT(largest_error(89), 50);
    EXPECT_THROW(write_image(image, folder / "a.jpg", {.quality = 0}), std::exception);
}

TEST(RoundTrip, GreyJpegStaysGrey) {
    const TemporaryFolder folder;
    Image image{cv::Mat(16, 16, CV_8UC1, cv::Scalar(77)), {}};
    write_image(image, folder / "a.jpg");
    const cv::Mat back = read_image(folder / "a.jpg").pixels;
    ASSERT_EQ(back.type(), CV_8UC1);
    EXPECT_LE(cv::norm(back, image.pixels, cv::NORM_INF), 1);
}

}  // namespace
}  // namespace puppetwarp
