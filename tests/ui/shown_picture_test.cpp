#include "model/shown_picture.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <cmath>

namespace puppetwarp::ui {
namespace {

TEST(ShownPictureTest, MultipliesColourByAlphaAndLeavesThePictureAlone) {
    Image image;
    image.pixels = cv::Mat(1, 256, CV_8UC4);
    for (int a = 0; a < 256; ++a)
        image.pixels.at<cv::Vec4b>(0, a) = cv::Vec4b(200, 100, 255, static_cast<std::uint8_t>(a));
    const cv::Mat before = image.pixels.clone();
    const cv::Mat shown = shown_picture(image, 1000);
    for (int a = 0; a < 256; ++a) {
        const auto pixel = shown.at<cv::Vec4b>(0, a);
        EXPECT_EQ(pixel[0], std::lround(200.0 * a / 255));
        EXPECT_EQ(pixel[1], std::lround(100.0 * a / 255));
        EXPECT_EQ(pixel[2], a);
        EXPECT_EQ(pixel[3], a);
    }
    EXPECT_EQ(cv::norm(before, image.pixels, cv::NORM_INF), 0);
}

TEST(ShownPictureTest, EveryDepthAndNumberOfChannelsShowsTheSame) {
    for (const int depth : {CV_8U, CV_16U, CV_32F}) {
        const double full = depth == CV_8U ? 255 : depth == CV_16U ? 65535 : 1;
        for (int channels = 1; channels <= 4; ++channels) {
            Image image;
            image.pixels = cv::Mat(3, 5, CV_MAKETYPE(depth, channels), cv::Scalar::all(full));
            const bool alpha = channels % 2 == 0;
            cv::Scalar colour = cv::Scalar::all(full * 0.4);
            if (alpha) colour[channels - 1] = full;
            image.pixels.setTo(colour);
            const cv::Mat shown = shown_picture(image, 1000);
            ASSERT_EQ(shown.type(), CV_8UC4);
            EXPECT_EQ(shown.at<cv::Vec4b>(2, 4), cv::Vec4b(102, 102, 102, 255)) << depth << ' ' << channels;
        }
    }
}

TEST(ShownPictureTest, ShrinksWhatTheScreenCannotHold) {
    Image image;
    image.pixels = cv::Mat(30, 400, CV_8UC3, cv::Scalar(10, 20, 30));
    const cv::Mat shown = shown_picture(image, 100);
    EXPECT_EQ(shown.cols, 100);
    EXPECT_EQ(shown.rows, 7);
    EXPECT_EQ(shown.at<cv::Vec4b>(3, 50), cv::Vec4b(10, 20, 30, 255));
    image.pixels = cv::Mat(1, 4000, CV_8UC3, cv::Scalar(10, 20, 30));
    EXPECT_EQ(shown_picture(image, 100).rows, 1);
}

}  // namespace
}  // namespace puppetwarp::ui
