#include "random_images.h"

#include <gtest/gtest.h>
#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/diff/compare.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace puppetwarp::testing {
namespace {

cv::Vec3b colour(const Image& map, int x, int y) {
    return map.pixels.at<cv::Vec3b>(y, x);
}

bool is_grey(const cv::Vec3b& value) {
    return value[0] == value[1] && value[1] == value[2];
}

int brightness(const cv::Vec3b& value) {
    return value[0] + value[1] + value[2];
}

TEST(HeatMap, ColoursExactlyThePixelsThatDiffer) {
    std::mt19937 random(5);
    for (int depth : {CV_8U, CV_16U, CV_32F}) {
        for (int channels = 1; channels <= 4; ++channels) {
            const Image expected = random_image(61, 83, depth, channels, random);
            const Image actual = changed_image(expected, depth, 20, random);
            const Image map = heat_map(expected, actual, {.threshold = 0.25});
            ASSERT_EQ(map.pixels.type(), CV_8UC3);
            ASSERT_EQ(map.pixels.size(), expected.pixels.size());
            for (int y = 0; y < expected.height(); ++y) {
                for (int x = 0; x < expected.width(); ++x) {
                    double largest = 0;
                    for (int channel = 0; channel < channels; ++channel) {
                        largest = std::max(largest,
                                           std::abs(sample(expected, y, x, channel) - sample(actual, y, x, channel)));
                    }
                    ASSERT_EQ(is_grey(colour(map, x, y)), largest <= 0.25) << x << "," << y << ": " << largest;
                }
            }
        }
    }
}

TEST(HeatMap, GoesFromYellowThroughRedToBlack) {
    Image expected = blank_image(256, 1, CV_8U, 1), actual = blank_image(256, 1, CV_8U, 1);
    for (int x = 0; x < 256; ++x) actual.pixels.at<std::uint8_t>(0, x) = static_cast<std::uint8_t>(x);
    const Image map = heat_map(expected, actual);
    const cv::Vec3b trace = colour(map, 1, 0), quarter = colour(map, 64, 0);
    EXPECT_EQ(trace[0], 255);
    EXPECT_GT(trace[1], 150);
    EXPECT_EQ(trace[2], 0);
    EXPECT_GT(quarter[0], 240);
    EXPECT_LT(quarter[1], 10);
    EXPECT_EQ(colour(map, 255, 0), cv::Vec3b(0, 0, 0));
    for (int x = 2; x < 256; ++x) EXPECT_LE(brightness(colour(map, x, 0)), brightness(colour(map, x - 1, 0)));
}

TEST(HeatMap, ShowsTheExpectedPicturePaleAndWhatIsTransparentWhite) {
    Image image = blank_image(3, 1, CV_8U, 4);
    image.pixels.at<cv::Vec4b>(0, 0) = {0, 0, 0, 255};
    image.pixels.at<cv::Vec4b>(0, 1) = {0, 0, 0, 0};
    image.pixels.at<cv::Vec4b>(0, 2) = {255, 255, 255, 255};
    const Image map = heat_map(image, image);
    EXPECT_EQ(colour(map, 0, 0), cv::Vec3b::all(153));
    EXPECT_EQ(colour(map, 1, 0), cv::Vec3b::all(255));
    EXPECT_EQ(colour(map, 2, 0), cv::Vec3b::all(255));
}

TEST(HeatMap, ASinglePixelOfALargePictureHasAHalo) {
    Image expected = blank_image(4000, 300, CV_8U, 1), actual = blank_image(4000, 300, CV_8U, 1);
    actual.pixels.at<std::uint8_t>(150, 2000) = 255;
    const Image map = heat_map(expected, actual);
    const cv::Vec3b untouched = colour(map, 0, 0);
    for (int y = 130; y < 170; ++y) {
        for (int x = 1980; x < 2020; ++x) {
            const bool near = std::abs(x - 2000) <= 10 && std::abs(y - 150) <= 10;
            ASSERT_EQ(colour(map, x, y) != untouched, near) << x << "," << y;
        }
    }
    EXPECT_EQ(colour(map, 2000, 150), cv::Vec3b(0, 0, 0));
    EXPECT_NE(colour(map, 2001, 150), cv::Vec3b(0, 0, 0));
}

TEST(HeatMap, ShowsToleratedAntialiasingBlueAndWhatTheWindowCounts) {
    // White below a slanted edge, soft in one picture and hard in the other; a faint spot away from it.
    Image soft = blank_image(40, 40, CV_8U, 1), hard = blank_image(40, 40, CV_8U, 1);
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 40; ++x) {
            const double cover = std::clamp(y - 8 - 0.3 * x, 0.0, 1.0);
            set_sample(soft, y, x, 0, cover);
            set_sample(hard, y, x, 0, std::round(cover));
        }
    }
    hard.pixels.at<std::uint8_t>(2, 30) = 2;
    const CompareOptions options{.threshold = 0.1, .antialiasing = true};
    const Image tolerated = heat_map(soft, hard, options);
    int blue = 0;
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 40; ++x) blue += colour(tolerated, x, y) == cv::Vec3b(40, 150, 255);
    }
    EXPECT_EQ(blue, compare(soft, hard, options).antialiased_pixels);
    EXPECT_GT(blue, 10);
    EXPECT_TRUE(is_grey(colour(tolerated, 30, 2)));
    CompareOptions window = options;
    window.window_px = 8;
    EXPECT_FALSE(is_grey(colour(heat_map(soft, hard, window), 30, 2)));
}

TEST(HeatMap, ShowsWhatAnEyeSeesWhenThatDecides) {
    Image expected = blank_image(60, 60, CV_8U, 3), actual = blank_image(60, 60, CV_8U, 3);
    actual.pixels(cv::Rect(25, 25, 10, 10)).setTo(cv::Scalar::all(200));
    const CompareOptions options{.metric = DiffMetric::flip, .threshold = 0.2};
    const Image map = heat_map(expected, actual, options);
    std::int64_t coloured = 0;
    for (int y = 0; y < 60; ++y) {
        for (int x = 0; x < 60; ++x)
            coloured += is_grey(colour(map, x, y)) && brightness(colour(map, x, y)) > 0 ? 0 : 1;
    }
    EXPECT_EQ(coloured, compare(expected, actual, options).differing_pixels);
    EXPECT_GT(coloured, 100);  // around the square, too
}

TEST(HeatMap, NanAndInfinityHaveColours) {
    Image expected = blank_image(3, 1, CV_32F, 3), actual = blank_image(3, 1, CV_32F, 3);
    expected.pixels.at<cv::Vec3f>(0, 0)[0] = std::numeric_limits<float>::quiet_NaN();
    actual.pixels.at<cv::Vec3f>(0, 1)[0] = std::numeric_limits<float>::infinity();
    const Image map = heat_map(expected, actual);
    EXPECT_EQ(colour(map, 0, 0), cv::Vec3b(0, 0, 0));
    EXPECT_EQ(colour(map, 1, 0), cv::Vec3b(0, 0, 0));
    EXPECT_EQ(colour(map, 2, 0), cv::Vec3b::all(153));
}

TEST(HeatMap, EveryNumberOfThreadsGivesTheSameBytes) {
    std::mt19937 random(2);
    const Image expected = random_image(500, 200, CV_16U, 4, random);
    const Image actual = changed_image(expected, CV_8U, 900, random);
    set_thread_count(4);
    const Image many = heat_map(expected, actual, {.threshold = 0.01});
    set_thread_count(1);
    const Image alone = heat_map(expected, actual, {.threshold = 0.01});
    set_thread_count(0);
    EXPECT_EQ(cv::norm(alone.pixels, many.pixels, cv::NORM_INF), 0);
}

TEST(HeatMap, PicturesOfAnotherSizeOrKindAreRefused) {
    const Image image = blank_image(4, 3, CV_8U, 3);
    EXPECT_THROW(heat_map(image, blank_image(3, 4, CV_8U, 3)), InvalidInput);
    EXPECT_THROW(heat_map(image, blank_image(4, 3, CV_8U, 4)), InvalidInput);
}

}  // namespace
}  // namespace puppetwarp::testing
