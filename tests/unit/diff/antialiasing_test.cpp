// Vysniauskas's rule, on pictures whose answer is plain to see and beside a plain loop on random ones.

#include "random_images.h"

#include <gtest/gtest.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/diff/compare.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>

namespace puppetwarp::testing {
namespace {

// White below a slanted edge, black above, the edge itself by coverage or in hard steps.
Image slanted_edge(double offset, bool antialiased) {
    Image image = blank_image(60, 40, CV_8U, 3);
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 60; ++x) {
            const double coverage = std::clamp(y - (10 + offset + 0.3 * x), 0.0, 1.0);
            set_sample(image, y, x, 0, antialiased ? coverage : std::round(coverage));
            set_sample(image, y, x, 1, antialiased ? coverage : std::round(coverage));
            set_sample(image, y, x, 2, antialiased ? coverage : std::round(coverage));
        }
    }
    return image;
}

TEST(Antialiasing, AnEdgeDrawnWithItAndOneDrawnWithoutAreTheSame) {
    const Image soft = slanted_edge(0, true), hard = slanted_edge(0, false);
    EXPECT_FALSE(compare(soft, hard).same);
    for (const auto& [expected, actual] : {std::pair{soft, hard}, {hard, soft}}) {
        const Comparison comparison = compare(expected, actual, {.antialiasing = true});
        EXPECT_TRUE(comparison.same) << comparison.reason;
        EXPECT_GT(comparison.antialiased_pixels, 20);
        EXPECT_EQ(comparison.differing_pixels, 0);
    }
}

TEST(Antialiasing, AnEdgeSomewhereElseIsNot) {
    const Comparison comparison = compare(slanted_edge(0, true), slanted_edge(3, true), {.antialiasing = true});
    EXPECT_FALSE(comparison.same);
    EXPECT_GT(comparison.differing_pixels, 60);
}

TEST(Antialiasing, ASpotIsNot) {
    Image flat = blank_image(20, 20, CV_8U, 1), spot = blank_image(20, 20, CV_8U, 1);
    spot.pixels.at<std::uint8_t>(9, 9) = 200;
    EXPECT_FALSE(compare(flat, spot, {.antialiasing = true}).same);
}

TEST(Antialiasing, HardFailAndWindowsKnowIt) {
    const Image soft = slanted_edge(0, true), hard = slanted_edge(0, false);
    EXPECT_FALSE(compare(soft, hard, {.hard_fail = 0.1, .antialiasing = true}).same);
    EXPECT_TRUE(compare(soft, hard, {.hard_fail = 0.6, .antialiasing = true}).same);
    EXPECT_FALSE(compare(soft, hard, {.threshold = 1, .window_px = 5}).same);
    EXPECT_TRUE(compare(soft, hard, {.threshold = 1, .antialiasing = true, .window_px = 5}).same);
}

// The rule in the words of its description, over whole grey pictures.
bool slow_rule(const cv::Mat& image, const cv::Mat& other, int x, int y) {
    const auto border = [&](int column, int row) {
        return column == 0 || row == 0 || column == image.cols - 1 || row == image.rows - 1;
    };
    const auto neighbours_equal = [&](const cv::Mat& picture, int column, int row) {
        int equal = border(column, row) ? 1 : 0;
        for (int v = std::max(0, row - 1); v <= std::min(image.rows - 1, row + 1); ++v) {
            for (int u = std::max(0, column - 1); u <= std::min(image.cols - 1, column + 1); ++u) {
                if (u == column && v == row) continue;
                equal += picture.at<std::uint8_t>(v, u) == picture.at<std::uint8_t>(row, column);
            }
        }
        return equal;
    };
    if (neighbours_equal(image, x, y) > 2) return false;
    int low = 256, high = -1;
    cv::Point lowest, highest;
    for (int v = std::max(0, y - 1); v <= std::min(image.rows - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(image.cols - 1, x + 1); ++u) {
            if (u == x && v == y) continue;
            const int value = image.at<std::uint8_t>(v, u);
            if (value < low) {
                low = value;
                lowest = {u, v};
            }
            if (value > high) {
                high = value;
                highest = {u, v};
            }
        }
    }
    const int own = image.at<std::uint8_t>(y, x);
    if (low >= own || high <= own) return false;
    const auto flat = [&](const cv::Point& at) {
        return neighbours_equal(image, at.x, at.y) >= 3 && neighbours_equal(other, at.x, at.y) >= 3;
    };
    return flat(lowest) || flat(highest);
}

TEST(Antialiasing, CountsThePixelsOfAPlainLoopWithAnyNumberOfThreads) {
    std::mt19937 random(21);
    for (int round = 0; round < 40; ++round) {
        Image expected = blank_image(30, 70, CV_8U, 1), actual;
        for (int y = 0; y < 70; ++y) {
            for (int x = 0; x < 30; ++x) {
                expected.pixels.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(random() % 8 < 5 ? 0 : random() % 4);
            }
        }
        actual.pixels = expected.pixels.clone();
        for (int i = 0; i < 300; ++i) {
            actual.pixels.at<std::uint8_t>(static_cast<int>(random() % 70), static_cast<int>(random() % 30)) = 2;
        }
        std::int64_t tolerated = 0, differing = 0;
        for (int y = 0; y < 70; ++y) {
            for (int x = 0; x < 30; ++x) {
                if (expected.pixels.at<std::uint8_t>(y, x) == actual.pixels.at<std::uint8_t>(y, x)) continue;
                ++(slow_rule(expected.pixels, actual.pixels, x, y) || slow_rule(actual.pixels, expected.pixels, x, y)
                       ? tolerated
                       : differing);
            }
        }
        for (const int threads : {1, 4}) {
            set_thread_count(threads);
            const Comparison comparison = compare(expected, actual, {.antialiasing = true});
            EXPECT_EQ(comparison.antialiased_pixels, tolerated);
            EXPECT_EQ(comparison.differing_pixels, differing);
        }
        set_thread_count(0);
        EXPECT_GT(tolerated, 0);
    }
}

TEST(Antialiasing, DepthAndAlphaChangeNothing) {
    const Image soft = slanted_edge(0, true), hard = slanted_edge(0, false);
    for (const int depth : {CV_16U, CV_32F}) {
        Image deep_soft = blank_image(60, 40, depth, 4), deep_hard = blank_image(60, 40, depth, 4);
        for (int y = 0; y < 40; ++y) {
            for (int x = 0; x < 60; ++x) {
                // Black on transparent ground: alpha is all that there is.
                set_sample(deep_soft, y, x, 3, sample(soft, y, x, 0));
                set_sample(deep_hard, y, x, 3, sample(hard, y, x, 0));
            }
        }
        EXPECT_TRUE(compare(deep_soft, deep_hard, {.antialiasing = true}).same) << depth;
    }
}

}  // namespace
}  // namespace puppetwarp::testing
