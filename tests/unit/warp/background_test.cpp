#include "scenes.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/warp/background.h>

#include <gtest/gtest.h>

namespace puppetwarp::testing {
namespace {

TEST(Background, NamesAreRead) {
    EXPECT_EQ(background_from_name("transparent").kind, Background::Kind::transparent);
    EXPECT_EQ(background_from_name("keep").kind, Background::Kind::keep);
    EXPECT_EQ(background_from_name("inpaint").kind, Background::Kind::inpaint);
    const Background colour = background_from_name("#Ff8000");
    EXPECT_EQ(colour.kind, Background::Kind::colour);
    EXPECT_EQ(colour.rgba, (std::array<double, 4>{1, 128 / 255.0, 0, 1}));
    EXPECT_EQ(background_from_name("#00000033").rgba[3], 51 / 255.0);
    for (const char* bad : {"", "#", "red", "#12345", "#1234567", "#12345g", "#-12345", "keep ", "#123456789"}) {
        EXPECT_THROW(background_from_name(bad), InvalidInput) << bad;
    }
}

TEST(Background, TransparentAndOpaquePicturesStayAsTheyAre) {
    Random random(1);
    const Image translucent = random_image(9, 7, CV_8UC4, random), opaque = random_image(9, 7, CV_8UC3, random);
    const Canvas canvas{0, 0, 9, 7};
    EXPECT_TRUE(same_bytes(lay_over({}, translucent, translucent, canvas).pixels, translucent.pixels));
    const Background red = background_from_name("#ff0000");
    EXPECT_TRUE(same_bytes(lay_over(red, opaque, opaque, canvas).pixels, opaque.pixels));
}

// Exact fractions, rounded once.
TEST(Background, ColoursAreBlendedWithOneRounding) {
    Image image{cv::Mat(256, 256, CV_8UC4), {}};
    for (int a = 0; a < 256; ++a) {
        for (int v = 0; v < 256; ++v) {
            image.pixels.at<cv::Vec4b>(a, v) = {static_cast<uchar>(v), 0, 255, static_cast<uchar>(a)};
        }
    }
    const Image original{cv::Mat(256, 256, CV_8UC3, cv::Scalar::all(0)), {}};
    const Image result = lay_over(background_from_name("#40c081"), image, original, {0, 0, 256, 256});
    ASSERT_EQ(result.pixels.type(), CV_8UC3);
    const int behind[3] = {0x40, 0xc0, 0x81};
    for (int a = 0; a < 256; ++a) {
        for (int v = 0; v < 256; ++v) {
            for (int c = 0; c < 3; ++c) {
                const int twice = 2 * (image.pixels.at<cv::Vec4b>(a, v)[c] * a + behind[c] * (255 - a));
                ASSERT_EQ(result.pixels.at<cv::Vec3b>(a, v)[c], (twice + 255) / 510);
            }
        }
    }
}

TEST(Background, AlphaStaysWhereThePictureHadItAndGoesWhereItHadNone) {
    Image translucent{cv::Mat(1, 2, CV_8UC4, cv::Scalar(10, 20, 30, 128)), {}};
    const Image without{cv::Mat(1, 2, CV_8UC3, cv::Scalar(1, 2, 3)), {}};
    const Image with = lay_over(background_from_name("#ffffff"), translucent, translucent, {0, 0, 2, 1});
    ASSERT_EQ(with.pixels.type(), CV_8UC4);
    EXPECT_EQ(with.pixels.at<cv::Vec4b>(0, 0)[3], 255);

    Image opaque{cv::Mat(1, 2, CV_8UC4, cv::Scalar(10, 20, 30, 255)), {}};
    EXPECT_EQ(lay_over(Background(), opaque, without, {0, 0, 2, 1}).pixels.type(), CV_8UC3);
    EXPECT_EQ(lay_over(Background(), translucent, without, {0, 0, 2, 1}).pixels.type(), CV_8UC4);
    EXPECT_EQ(lay_over(Background(), opaque, translucent, {0, 0, 2, 1}).pixels.type(), CV_8UC4);
}

TEST(Background, TranslucentColoursKeepAlpha) {
    Image image{cv::Mat(1, 3, CV_16UC4), {}};
    image.pixels.at<cv::Vec4w>(0, 0) = {100, 200, 300, 65535};
    image.pixels.at<cv::Vec4w>(0, 1) = {7, 7, 7, 0};
    image.pixels.at<cv::Vec4w>(0, 2) = {0, 0, 65535, 32768};
    const Image result = lay_over(background_from_name("#ff000080"), image, image, {0, 0, 3, 1});
    ASSERT_EQ(result.pixels.type(), CV_16UC4);
    EXPECT_EQ(result.pixels.at<cv::Vec4w>(0, 0), cv::Vec4w(100, 200, 300, 65535));
    EXPECT_EQ(result.pixels.at<cv::Vec4w>(0, 1), cv::Vec4w(65535, 0, 0, 0x8080));
    const double front = 32768 / 65535.0, back = 0x80 / 255.0 * (1 - front);
    EXPECT_NEAR(result.pixels.at<cv::Vec4w>(0, 2)[3], 65535 * (front + back), 0.5001);
    EXPECT_NEAR(result.pixels.at<cv::Vec4w>(0, 2)[2], 65535 * front / (front + back), 0.5001);
    EXPECT_NEAR(result.pixels.at<cv::Vec4w>(0, 2)[0], 65535 * back / (front + back), 0.5001);
}

TEST(Background, KeepShowsTheOriginalWhereTheCanvasMeetsIt) {
    Random random(2);
    const Image original = random_image(6, 5, CV_8UC3, random);
    Image warped{cv::Mat(4, 4, CV_8UC4, cv::Scalar(0, 0, 0, 0)), {}};
    warped.pixels.at<cv::Vec4b>(1, 1) = {1, 2, 3, 255};
    const Background keep = background_from_name("keep");

    const Image inside = lay_over(keep, warped, original, {2, 1, 4, 4});
    ASSERT_EQ(inside.pixels.type(), CV_8UC3);
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 4; ++x) {
            const cv::Vec3b expected =
                x == 1 && y == 1 ? cv::Vec3b(1, 2, 3) : original.pixels.at<cv::Vec3b>(y + 1, x + 2);
            EXPECT_EQ(inside.pixels.at<cv::Vec3b>(y, x), expected);
        }
    }
    const Image beyond = lay_over(keep, warped, original, {-1, -2, 4, 4});
    ASSERT_EQ(beyond.pixels.type(), CV_8UC4);
    EXPECT_EQ(beyond.pixels.at<cv::Vec4b>(0, 0)[3], 0);
    EXPECT_EQ(beyond.pixels.at<cv::Vec4b>(1, 1), cv::Vec4b(1, 2, 3, 255));
    const cv::Vec3b corner = original.pixels.at<cv::Vec3b>(1, 2);
    EXPECT_EQ(beyond.pixels.at<cv::Vec4b>(3, 3), cv::Vec4b(corner[0], corner[1], corner[2], 255));
}

TEST(Background, GreyStaysGrey) {
    Image image{cv::Mat(1, 2, CV_32FC2), {}};
    image.pixels.at<cv::Vec2f>(0, 0) = {0.25F, 1};
    image.pixels.at<cv::Vec2f>(0, 1) = {0.5F, 0.5F};
    const Image original{cv::Mat(1, 2, CV_32FC1, cv::Scalar::all(0)), {}};
    const Image result = lay_over(background_from_name("#ffffff"), image, original, {0, 0, 2, 1});
    ASSERT_EQ(result.pixels.type(), CV_32FC1);
    EXPECT_FLOAT_EQ(result.pixels.at<float>(0, 0), 0.25F);
    EXPECT_FLOAT_EQ(result.pixels.at<float>(0, 1), 0.75F);
}

}  // namespace
}  // namespace puppetwarp::testing
