// What happens to what a format cannot hold.
#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>

#include "test_pictures.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <cmath>
#include <limits>

namespace puppetwarp {
namespace {

using test::noise;
using test::same;
using test::TemporaryFolder;

Image through(const Image& image, const char* name) {
    const TemporaryFolder folder;
    write_image(image, folder / name);
    return read_image(folder / name);
}

TEST(Convert, SixteenBitsRoundToTheNearestOfEight) {
    Image image{cv::Mat(256, 256, CV_16UC3), {}};
    for (int y = 0; y < 256; ++y) {
        for (int x = 0; x < 256; ++x)
            image.pixels.at<cv::Vec3w>(y, x) = cv::Vec3w::all(static_cast<ushort>(y * 256 + x));
    }
    const Image back = through(image, "a.webp");
    ASSERT_EQ(back.pixels.type(), CV_8UC3);
    for (int i = 0; i < 65536; ++i) {
        ASSERT_EQ(back.pixels.at<cv::Vec3b>(i / 256, i % 256)[0], std::lround(i / 257.0)) << i;
    }
}

TEST(Convert, EightAndSixteenBitsThroughFloatsAndBackAreThemselves) {
    for (const int depth : {CV_8U, CV_16U}) {
        const Image image{noise(300, 200, depth, 3, 6), {}};
        for (const char* name : {"a.pfm", "a.exr"}) {
            Image floats = through(image, name);
            ASSERT_EQ(floats.pixels.type(), CV_32FC3);
            const Image back = through(floats, "a.png");  // floats become 16 bits
            ASSERT_EQ(back.pixels.type(), CV_16UC3);
            cv::Mat expected = image.pixels;
            if (depth == CV_8U) image.pixels.convertTo(expected, CV_16U, 257);
            EXPECT_TRUE(same(back.pixels, expected)) << name;
        }
    }
}

TEST(Convert, FloatsOutsideAndNotNumbersAreClamped) {
    Image image{cv::Mat(1, 5, CV_32FC1), {}};
    const float values[5] = {-1, 2, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                             0.5f};
    std::copy_n(values, 5, image.pixels.ptr<float>());
    const Image back = through(image, "a.png");
    ASSERT_EQ(back.pixels.type(), CV_16UC1);
    const ushort expected[5] = {0, 65535, 0, 65535, 32768};
    for (int x = 0; x < 5; ++x) EXPECT_EQ(back.pixels.at<ushort>(0, x), expected[x]) << x;
}

TEST(Convert, AlphaIsLaidOverWhite) {
    Image image{cv::Mat(256, 256, CV_8UC4), {}};
    for (int y = 0; y < 256; ++y) {
        for (int x = 0; x < 256; ++x) image.pixels.at<cv::Vec4b>(y, x) = cv::Vec4b(uchar(x), 0, 255, uchar(y));
    }
    const Image back = through(image, "a.ppm");
    ASSERT_EQ(back.pixels.type(), CV_8UC3);
    for (int a = 0; a < 256; ++a) {
        for (int v = 0; v < 256; ++v) {
            const auto& pixel = back.pixels.at<cv::Vec3b>(a, v);
            ASSERT_NEAR(pixel[0], (v * a + 255.0 * (255 - a)) / 255, 0.5 + 1e-9);
            ASSERT_EQ(pixel[1], 255 - a);
            ASSERT_EQ(pixel[2], 255);
        }
    }
}

TEST(Convert, GreyWithAlphaIsLaidOverWhiteInEveryDepth) {
    for (const int depth : {CV_8U, CV_16U, CV_32F}) {
        Image image{cv::Mat(1, 2, CV_MAKETYPE(depth, 2)), {}};
        image.pixels.setTo(cv::Scalar::all(0));  // black, wholly transparent
        image.pixels.col(1).setTo(cv::Scalar::all(image.full_value()));
        const Image back = through(image, depth == CV_32F ? "a.pfm" : "a.pgm");
        ASSERT_EQ(back.pixels.channels(), 1);
        EXPECT_EQ(cv::norm(back.pixels, cv::NORM_INF), back.full_value());
        double smallest = 0;
        cv::minMaxLoc(back.pixels, &smallest);
        EXPECT_EQ(smallest, back.full_value());
    }
}

TEST(Convert, ColourIntoAGreyMapKeepsGreysAndWeighsColoursByLuma) {
    Image image{cv::Mat(1, 4, CV_8UC3), {}};
    const cv::Vec3b colours[4] = {{90, 90, 90}, {255, 0, 0}, {0, 255, 0}, {0, 0, 255}};
    std::copy_n(colours, 4, image.pixels.ptr<cv::Vec3b>());
    const Image back = through(image, "a.pgm");
    ASSERT_EQ(back.pixels.type(), CV_8UC1);
    const int expected[4] = {90, 54, 182, 18};  // 255 times BT.709's 0.2126, 0.7152, 0.0722
    for (int x = 0; x < 4; ++x) EXPECT_EQ(back.pixels.at<uchar>(0, x), expected[x]);
}

TEST(Convert, GreyIntoAColourMapIsThreeTimesTheSame) {
    const Image image{noise(9, 5, CV_16U, 1, 6), {}};
    const Image back = through(image, "a.ppm");
    ASSERT_EQ(back.pixels.type(), CV_16UC3);
    for (int y = 0; y < 5; ++y) {
        for (int x = 0; x < 9; ++x)
            EXPECT_EQ(back.pixels.at<cv::Vec3w>(y, x), cv::Vec3w::all(image.pixels.at<ushort>(y, x)));
    }
}

}  // namespace
}  // namespace puppetwarp
