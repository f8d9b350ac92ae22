// Structural similarity beside a plain double-precision loop after the paper's equations, and closed forms.

#include "random_images.h"

#include <gtest/gtest.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/diff/compare.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace puppetwarp::testing {
namespace {

double similarity(const Image& expected, const Image& actual, CompareOptions options = {}) {
    options.metric = DiffMetric::ssim;
    return compare(expected, actual, options).ssim.value();
}

double luma(const Image& image, int x, int y) {
    if (image.pixels.channels() < 3) return sample(image, y, x, 0);
    return 0.299 * sample(image, y, x, 0) + 0.587 * sample(image, y, x, 1) + 0.114 * sample(image, y, x, 2);
}

// Wang 2004, equations 13 to 17, window by window, each with its own sums.
double window_similarity(const Image& a, const Image& b, int left, int top, int columns, int rows) {
    double weights = 0, mean_a = 0, mean_b = 0;
    std::vector<double> weight;
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            const double dx = x - (columns - 1) / 2, dy = y - (rows - 1) / 2;
            weight.push_back(std::exp(-(dx * dx + dy * dy) / (2 * 1.5 * 1.5)));
            weights += weight.back();
        }
    }
    const auto at = [&](int x, int y) { return weight[static_cast<std::size_t>(y * columns + x)] / weights; };
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            mean_a += at(x, y) * luma(a, left + x, top + y);
            mean_b += at(x, y) * luma(b, left + x, top + y);
        }
    }
    double variance_a = 0, variance_b = 0, covariance = 0;
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            const double p = luma(a, left + x, top + y) - mean_a, q = luma(b, left + x, top + y) - mean_b;
            variance_a += at(x, y) * p * p;
            variance_b += at(x, y) * q * q;
            covariance += at(x, y) * p * q;
        }
    }
    const double c1 = 1e-4, c2 = 9e-4;
    return (2 * mean_a * mean_b + c1) * (2 * covariance + c2) /
           ((mean_a * mean_a + mean_b * mean_b + c1) * (variance_a + variance_b + c2));
}

double slow_similarity(const Image& a, const Image& b) {
    const auto odd = [](int side) { return std::min(11, side - 1 + side % 2); };
    const int columns = odd(a.width()), rows = odd(a.height());
    double sum = 0;
    int windows = 0;
    for (int top = 0; top + rows <= a.height(); ++top) {
        for (int left = 0; left + columns <= a.width(); ++left) {
            sum += window_similarity(a, b, left, top, columns, rows);
            ++windows;
        }
    }
    return sum / windows;
}

TEST(Ssim, OfTracesIsNotRoundedOverOne) {
    for (int value = 0; value < 65535; value += 1111) {
        Image expected = blank_image(24, 24, CV_16U, 3), actual = blank_image(24, 24, CV_16U, 3);
        expected.pixels.setTo(cv::Scalar::all(value));
        actual.pixels.setTo(cv::Scalar(value, value + 1, value));
        EXPECT_LE(similarity(expected, actual), 1) << value;
    }
}

TEST(Ssim, IsThatOfThePaperInEveryDepthAndChannelCount) {
    std::mt19937 random(3);
    for (const int depth : {CV_8U, CV_16U, CV_32F}) {
        for (const int channels : {1, 3}) {
            for (const int rarity : {1, 8, 200}) {
                const Image expected = random_image(53, 91, depth, channels, random);
                const Image actual = changed_image(expected, depth, rarity, random);
                EXPECT_NEAR(similarity(expected, actual), slow_similarity(expected, actual), 2e-6)
                    << depth << ", " << channels << " channels, 1 in " << rarity;
            }
        }
    }
}

TEST(Ssim, RowsWithTheSameBytesAreNotLookedAtAndChangeNothing) {
    std::mt19937 random(13);
    const Image expected = random_image(70, 400, CV_8U, 3, random);
    Image actual;
    actual.pixels = expected.pixels.clone();
    for (const int y : {0, 63, 64, 200, 399}) actual.pixels.at<cv::Vec3b>(y, 40) = {0, 0, 0};
    EXPECT_NEAR(1 - similarity(expected, actual), 1 - slow_similarity(expected, actual), 1e-8);
}

TEST(Ssim, ReadsSmoothBrightPicturesWithoutLosingTheirSmallVariances) {
    Image expected = blank_image(80, 80, CV_16U, 1), actual = blank_image(80, 80, CV_16U, 1);
    for (int y = 0; y < 80; ++y) {
        for (int x = 0; x < 80; ++x) {
            set_sample(expected, y, x, 0, 0.95 + 0.01 * std::sin(0.3 * x));
            set_sample(actual, y, x, 0, 0.95 + 0.01 * std::sin(0.3 * x + 0.5) + 0.002 * std::cos(0.2 * y));
        }
    }
    EXPECT_NEAR(similarity(expected, actual), slow_similarity(expected, actual), 1e-5);
}

TEST(Ssim, OfTwoFlatPicturesIsTheLuminanceTermAlone) {
    Image expected = blank_image(20, 20, CV_32F, 1), actual = blank_image(20, 20, CV_32F, 1);
    expected.pixels.setTo(0.25);
    actual.pixels.setTo(0.75);
    EXPECT_NEAR(similarity(expected, actual), (2 * 0.25 * 0.75 + 1e-4) / (0.25 * 0.25 + 0.75 * 0.75 + 1e-4), 1e-6);
}

TEST(Ssim, OfANegativeIsNegativeAndOfThePictureItselfExactlyOne) {
    std::mt19937 random(4);
    const Image expected = random_image(40, 40, CV_8U, 3, random);
    Image negative;
    cv::Mat(cv::Scalar::all(255) - expected.pixels).copyTo(negative.pixels);
    EXPECT_LT(similarity(expected, negative), -0.8);
    EXPECT_EQ(similarity(expected, expected), 1);
    EXPECT_TRUE(compare(expected, expected, {.metric = DiffMetric::ssim}).same);
}

TEST(Ssim, PicturesSmallerThanTheWindowHaveASmallerOne) {
    std::mt19937 random(5);
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 2}, {1, 30}, {10, 11}, {7, 4}, {11, 11}, {12, 3}}) {
        const Image expected = random_image(width, height, CV_8U, 3, random);
        const Image actual = changed_image(expected, CV_8U, 2, random);
        EXPECT_NEAR(similarity(expected, actual), slow_similarity(expected, actual), 2e-6) << width << " x " << height;
    }
}

TEST(Ssim, TransparentPicturesAreSeenOverBlackAndOverWhite) {
    // Black on transparent ground: over black nothing is to be seen.
    Image expected = blank_image(30, 30, CV_8U, 4), actual = blank_image(30, 30, CV_8U, 4);
    for (int y = 10; y < 20; ++y) {
        for (int x = 10; x < 20; ++x) actual.pixels.at<cv::Vec4b>(y, x)[3] = 255;
    }
    EXPECT_LT(similarity(expected, actual), 0.9);
    EXPECT_EQ(similarity(expected, actual, {.alpha = AlphaRule::ignore}), 1);
    // Colours under alpha 0 are invisible.
    expected.pixels.at<cv::Vec4b>(2, 2) = {200, 0, 0, 0};
    EXPECT_EQ(similarity(expected, blank_image(30, 30, CV_8U, 4)), 1);
}

TEST(Ssim, WhatIsNotComparedDoesNotCount) {
    std::mt19937 random(6);
    const Image expected = random_image(60, 50, CV_8U, 1, random);
    Image actual;
    actual.pixels = expected.pixels.clone();
    actual.pixels(cv::Rect(0, 0, 12, 50)).setTo(0);
    actual.pixels(cv::Rect(40, 0, 20, 50)).setTo(255);
    CompareOptions options{.ignore = {{0, 0, 12, 50}}};
    EXPECT_LT(similarity(expected, actual, options), 0.9);
    options.ignore.push_back({40, 0, 20, 50});
    EXPECT_EQ(similarity(expected, actual, options), 1);
    // A strip along the border, nearer to it than any window's middle.
    cv::Mat mask = cv::Mat::zeros(50, 60, CV_8U);
    mask(cv::Rect(0, 0, 60, 3)).setTo(1);
    EXPECT_LT(similarity(expected, actual, {.mask = mask}), 0.99);
}

TEST(Ssim, NanEqualsOnlyNan) {
    std::mt19937 random(7);
    Image expected = random_image(20, 20, CV_32F, 1, random);
    expected.pixels.at<float>(9, 9) = std::numeric_limits<float>::quiet_NaN();
    Image actual;
    actual.pixels = expected.pixels.clone();
    EXPECT_EQ(similarity(expected, actual), 1);
    actual.pixels.at<float>(9, 9) = 0;
    const double other = similarity(expected, actual);
    EXPECT_LT(other, 0.99);
    EXPECT_GT(other, 0);
}

TEST(Ssim, EveryNumberOfThreadsGivesTheSameBits) {
    std::mt19937 random(8);
    const Image expected = random_image(90, 400, CV_8U, 3, random);
    const Image actual = changed_image(expected, CV_8U, 3, random);
    set_thread_count(4);
    const double many = similarity(expected, actual);
    set_thread_count(1);
    const double alone = similarity(expected, actual);
    set_thread_count(0);
    EXPECT_EQ(many, alone);
}

}  // namespace
}  // namespace puppetwarp::testing
