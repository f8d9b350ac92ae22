// Pictures that fit after a move.

#include "random_images.h"

#include <gtest/gtest.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/diff/compare.h>
#include <opencv2/core.hpp>

#include <cmath>
#include <limits>

namespace puppetwarp::testing {
namespace {

// Two cuts from one picture, the actual one begun `x`, `y` further to the upper left.
struct Cuts {
    Image expected, actual;

    Cuts(const Image& whole, int x, int y) {
        expected.pixels = whole.pixels(cv::Rect(20, 20, 80, 60));
        actual.pixels = whole.pixels(cv::Rect(20 - x, 20 - y, 80, 60));
    }
};

TEST(Shift, FindsTheMoveWithinItsReachOnly) {
    std::mt19937 random(1);
    for (const int depth : {CV_8U, CV_16U, CV_32F}) {
        const Image whole = random_image(120, 100, depth, 3, random);
        for (const auto& [x, y] : {std::pair{0, 0}, {3, 0}, {0, -4}, {-5, 5}, {5, 2}}) {
            const Cuts cuts(whole, x, y);
            const Comparison comparison = compare(cuts.expected, cuts.actual, {.shift_px = 5});
            EXPECT_TRUE(comparison.same);
            EXPECT_EQ(comparison.shift_x, x);
            EXPECT_EQ(comparison.shift_y, y);
            EXPECT_EQ(comparison.compared_pixels, (80 - std::abs(x)) * (60 - std::abs(y)));
        }
        EXPECT_FALSE(compare(Cuts(whole, 6, 0).expected, Cuts(whole, 6, 0).actual, {.shift_px = 5}).same);
        EXPECT_FALSE(compare(Cuts(whole, 1, 0).expected, Cuts(whole, 1, 0).actual).same);
    }
}

TEST(Shift, WhatStillDiffersHasItsPlaceInTheExpectedPicture) {
    std::mt19937 random(2);
    Image whole = random_image(120, 100, CV_8U, 4, random);
    Cuts cuts(whole, 2, -3);
    cuts.actual.pixels = cuts.actual.pixels.clone();
    cuts.actual.pixels.at<cv::Vec4b>(30 - 3, 40 + 2)[1] ^= 64;
    const Comparison comparison = compare(cuts.expected, cuts.actual, {.shift_px = 4});
    EXPECT_EQ(comparison.differing_pixels, 1);
    EXPECT_EQ(comparison.max_x, 40);
    EXPECT_EQ(comparison.max_y, 30);
    EXPECT_EQ(comparison.box_x, 40);
    EXPECT_EQ(comparison.box_y, 30);
    EXPECT_EQ(comparison.expected_at_max[1], sample(cuts.expected, 30, 40, 1));
}

TEST(Shift, OfEqualFitsTheShortestMoveIsTaken) {
    // Vertical stripes, four wide: moves by 4 fit as well as none, and along y all do.
    Image stripes = blank_image(64, 40, CV_8U, 1);
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 64; ++x) stripes.pixels.at<std::uint8_t>(y, x) = x % 4 == 0 ? 255 : 0;
    }
    const Comparison still = compare(stripes, stripes, {.shift_px = 8});
    EXPECT_EQ(still.shift_x, 0);
    EXPECT_EQ(still.shift_y, 0);
    Image moved;
    moved.pixels = stripes.pixels.clone();
    stripes.pixels.colRange(0, 63).copyTo(moved.pixels.colRange(1, 64));
    moved.pixels.col(0).setTo(0);
    const Comparison comparison = compare(stripes, moved, {.shift_px = 8});
    EXPECT_TRUE(comparison.same);
    EXPECT_EQ(comparison.shift_x, 1);
    EXPECT_EQ(comparison.shift_y, 0);
}

TEST(Shift, TheBestFitIsThatOfAPlainSearch) {
    std::mt19937 random(3);
    for (int round = 0; round < 10; ++round) {
        const Image expected = random_image(23, 17, CV_8U, 1, random), actual = random_image(23, 17, CV_8U, 1, random);
        double least = std::numeric_limits<double>::infinity();
        for (int v = -4; v <= 4; ++v) {
            for (int u = -4; u <= 4; ++u) {
                double sum = 0;
                int pixels = 0;
                for (int y = std::max(0, -v); y < std::min(17, 17 - v); ++y) {
                    for (int x = std::max(0, -u); x < std::min(23, 23 - u); ++x, ++pixels) {
                        sum += std::abs(sample(expected, y, x, 0) - sample(actual, y + v, x + u, 0));
                    }
                }
                least = std::min(least, sum / pixels);
            }
        }
        for (const int threads : {1, 4}) {
            set_thread_count(threads);
            EXPECT_NEAR(compare(expected, actual, {.shift_px = 4}).mean, least, 1e-12);
        }
        set_thread_count(0);
    }
}

TEST(Shift, LittleIsNotMadeToFit) {
    // Four columns in common would fit; half of each side must be compared, and half of what is selected.
    Image left = blank_image(9, 9, CV_8U, 1), right = blank_image(9, 9, CV_8U, 1);
    left.pixels.colRange(4, 9).setTo(255);
    right.pixels.colRange(0, 5).setTo(128);
    EXPECT_FALSE(compare(left, right, {.shift_px = 64}).same);
    cv::Mat mask = cv::Mat::zeros(9, 9, CV_8U);
    mask.col(0).setTo(1);
    right.pixels.setTo(128);
    EXPECT_FALSE(compare(left, right, {.shift_px = 4, .mask = mask}).same);
}

TEST(Shift, HeatMapsTintWhatHasNoCounterpart) {
    std::mt19937 random(4);
    const Cuts cuts(random_image(120, 100, CV_8U, 1, random), 3, 0);
    const Image map = heat_map(cuts.expected, cuts.actual, {.shift_px = 4});
    EXPECT_EQ(map.width(), 80);
    const cv::Vec3b compared = map.pixels.at<cv::Vec3b>(5, 5), beyond = map.pixels.at<cv::Vec3b>(5, 78);
    EXPECT_EQ(compared[0], compared[2]);
    EXPECT_LT(beyond[0], beyond[2]);
}

}  // namespace
}  // namespace puppetwarp::testing
