#include "random_images.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/diff/compare.h>

#include <algorithm>
#include <limits>

namespace puppetwarp::testing {
namespace {

using ::testing::HasSubstr;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

double rounded_to_float(double value, bool round) {
    return round ? static_cast<double>(static_cast<float>(value)) : value;
}

// One plain loop over doubles, with no bands and no integers.
Comparison naive_compare(const Image& expected, const Image& actual, double threshold) {
    Comparison result;
    result.width = expected.width();
    result.height = expected.height();
    const bool floats = expected.pixels.depth() == CV_32F || actual.pixels.depth() == CV_32F;
    const int channels = expected.pixels.channels();
    double sum = 0, squares = 0;
    int right = -1, bottom = -1;
    for (int y = 0; y < result.height; ++y) {
        for (int x = 0; x < result.width; ++x) {
            bool differs = false;
            for (int channel = 0; channel < channels; ++channel) {
                const double difference = std::abs(rounded_to_float(sample(expected, y, x, channel), floats) -
                                                   rounded_to_float(sample(actual, y, x, channel), floats));
                sum += difference;
                squares += difference * difference;
                if (difference > result.max + 1e-12) {
                    result.max = difference;
                    result.max_x = x;
                    result.max_y = y;
                }
                differs = differs || difference > threshold + 1e-12;
            }
            if (!differs) continue;
            if (result.differing_pixels++ == 0) {
                result.box_x = right = x;
                result.box_y = y;
            }
            result.box_x = std::min(result.box_x, x);
            right = std::max(right, x);
            bottom = y;
        }
    }
    const double samples = static_cast<double>(result.width) * result.height * channels;
    result.mean = sum / samples;
    result.rmse = std::sqrt(squares / samples);
    result.psnr = squares > 0 ? 10 * std::log10(samples / squares) : kInfinity;
    result.differing_percent =
        100.0 * static_cast<double>(result.differing_pixels) / (static_cast<double>(result.width) * result.height);
    result.same = result.differing_pixels == 0;
    if (!result.same) {
        result.box_width = right - result.box_x + 1;
        result.box_height = bottom - result.box_y + 1;
    }
    return result;
}

void expect_like(const Comparison& got, const Comparison& want) {
    EXPECT_TRUE(got.comparable);
    EXPECT_EQ(got.same, want.same);
    EXPECT_EQ(got.reason.empty(), want.same);
    EXPECT_EQ(got.width, want.width);
    EXPECT_EQ(got.height, want.height);
    EXPECT_NEAR(got.max, want.max, 1e-12);
    EXPECT_EQ(got.max_x, want.max_x);
    EXPECT_EQ(got.max_y, want.max_y);
    EXPECT_NEAR(got.mean, want.mean, 1e-12);
    EXPECT_NEAR(got.rmse, want.rmse, 1e-12);
    if (want.psnr == kInfinity) {
        EXPECT_EQ(got.psnr, kInfinity);
    } else {
        EXPECT_NEAR(got.psnr, want.psnr, 1e-9);
    }
    EXPECT_EQ(got.differing_pixels, want.differing_pixels);
    EXPECT_NEAR(got.differing_percent, want.differing_percent, 1e-9);
    EXPECT_EQ(got.box_x, want.box_x);
    EXPECT_EQ(got.box_y, want.box_y);
    EXPECT_EQ(got.box_width, want.box_width);
    EXPECT_EQ(got.box_height, want.box_height);
}

TEST(Compare, FiguresAreThoseOfAPlainLoopInEveryDepthAndChannelCount) {
    std::mt19937 random(7);
    for (int expected_depth : {CV_8U, CV_16U, CV_32F}) {
        for (int actual_depth : {CV_8U, CV_16U, CV_32F}) {
            for (int channels = 1; channels <= 4; ++channels) {
                for (int rarity : {1, 60, 3000}) {
                    SCOPED_TRACE(::testing::Message() << expected_depth << " against " << actual_depth << ", "
                                                      << channels << " channels, 1 in " << rarity);
                    const int width = 1 + static_cast<int>(random() % 70),
                              height = 1 + static_cast<int>(random() % 150);
                    const Image expected = random_image(width, height, expected_depth, channels, random);
                    const Image actual = changed_image(expected, actual_depth, rarity, random);
                    const double threshold = rarity == 60 ? 0.3 : 0;
                    expect_like(compare(expected, actual, {.threshold = threshold}),
                                naive_compare(expected, actual, threshold));
                }
            }
        }
    }
}

TEST(Compare, EveryEightBitValueEqualsItsSixteenBitAndItsFloatValue) {
    Image bytes = blank_image(256, 1, CV_8U, 1), words = blank_image(256, 1, CV_16U, 1),
          floats = blank_image(256, 1, CV_32F, 1);
    for (int value = 0; value < 256; ++value) {
        bytes.pixels.at<std::uint8_t>(0, value) = static_cast<std::uint8_t>(value);
        words.pixels.at<std::uint16_t>(0, value) = static_cast<std::uint16_t>(value * 257);
        floats.pixels.at<float>(0, value) = static_cast<float>(value) / 255.0F;
    }
    EXPECT_EQ(compare(bytes, words).max, 0);
    EXPECT_EQ(compare(words, bytes).max, 0);
    EXPECT_EQ(compare(bytes, floats).max, 0);
    words.pixels.at<std::uint16_t>(0, 9) += 1;
    const Comparison off_by_one = compare(bytes, words);
    EXPECT_FALSE(off_by_one.same);
    EXPECT_EQ(off_by_one.max, 1.0 / 65535);
    EXPECT_EQ(off_by_one.max_x, 9);
}

TEST(Compare, AThresholdOfSomeLevelsLetsExactlyThatManyPass) {
    for (int allowed = 0; allowed < 255; ++allowed) {
        Image expected = blank_image(1, 1, CV_8U, 1), actual = expected;
        actual.pixels = cv::Mat(1, 1, CV_8U, cv::Scalar(allowed));
        const CompareOptions options{.threshold = allowed / 255.0};
        EXPECT_TRUE(compare(expected, actual, options).same) << allowed;
        actual.pixels = cv::Mat(1, 1, CV_8U, cv::Scalar(allowed + 1));
        EXPECT_FALSE(compare(expected, actual, options).same) << allowed;
    }
}

TEST(Compare, BelowTheThresholdTheFiguresStillSayWhatDiffers) {
    Image expected = blank_image(10, 10, CV_8U, 3), actual = expected;
    actual.pixels = expected.pixels.clone();
    actual.pixels.at<cv::Vec3b>(4, 7)[1] = 3;
    const Comparison comparison = compare(expected, actual, {.threshold = 3 / 255.0});
    EXPECT_TRUE(comparison.same);
    EXPECT_EQ(comparison.max, 3 / 255.0);
    EXPECT_EQ(comparison.max_x, 7);
    EXPECT_EQ(comparison.max_y, 4);
    EXPECT_EQ(comparison.box_width, 0);
    EXPECT_GT(comparison.rmse, 0);
}

TEST(Compare, OfEqualMaximaTheFirstInReadingOrderIsNamed) {
    Image expected = blank_image(5, 200, CV_16U, 2), actual = expected;
    actual.pixels = expected.pixels.clone();
    for (int y : {150, 77, 190}) actual.pixels.at<cv::Vec2w>(y, y % 5)[1] = 65535;
    const Comparison comparison = compare(expected, actual);
    EXPECT_EQ(comparison.max_x, 2);
    EXPECT_EQ(comparison.max_y, 77);
}

TEST(Compare, AnotherSizeOrAnotherKindIsDifferentAndSaysWhy) {
    const Image grey = blank_image(4, 3, CV_8U, 1), colour = blank_image(4, 3, CV_8U, 3),
                tall = blank_image(3, 4, CV_8U, 1);
    const Comparison kinds = compare(grey, colour);
    EXPECT_FALSE(kinds.same);
    EXPECT_FALSE(kinds.comparable);
    EXPECT_THAT(kinds.reason, HasSubstr("expected grey, actual RGB"));
    const Comparison sizes = compare(grey, tall);
    EXPECT_FALSE(sizes.same);
    EXPECT_FALSE(sizes.comparable);
    EXPECT_THAT(sizes.reason, HasSubstr("expected 4 x 3, actual 3 x 4"));
}

TEST(Compare, NanEqualsOnlyNan) {
    Image expected = blank_image(3, 1, CV_32F, 1), actual = expected;
    expected.pixels = (cv::Mat_<float>(1, 3) << kNan, 0.5F, 0.25F);
    actual.pixels = expected.pixels.clone();
    EXPECT_TRUE(compare(expected, actual).same);
    actual.pixels.at<float>(0, 2) = kNan;
    const Comparison comparison = compare(expected, actual, {.threshold = 1});
    EXPECT_FALSE(comparison.same);
    EXPECT_EQ(comparison.differing_pixels, 1);
    EXPECT_EQ(comparison.max_x, 2);
    EXPECT_EQ(comparison.max, kInfinity);
    EXPECT_EQ(comparison.psnr, -kInfinity);
    // NaN of another bit pattern, so that equal bytes are not what makes them equal.
    actual.pixels = (cv::Mat_<float>(1, 3) << -kNan, 0.5F, 0.25F);
    EXPECT_TRUE(compare(expected, actual).same);
}

TEST(Compare, LongRowsOfTheLargestDifferencesAreSummedExactly) {
    for (const int depth : {CV_8U, CV_16U}) {
        const Image black = blank_image(60000, 3, depth, 4);
        Image white = blank_image(60000, 3, depth, 4);
        white.pixels.setTo(cv::Scalar::all(white.full_value()));
        const Comparison comparison = compare(black, white);
        EXPECT_EQ(comparison.mean, 1);
        EXPECT_EQ(comparison.rmse, 1);
        EXPECT_EQ(comparison.psnr, 0);
        EXPECT_EQ(comparison.differing_pixels, 180000);
    }
}

TEST(Compare, InfinityEqualsItself) {
    Image expected = blank_image(2, 1, CV_32F, 1), actual = expected;
    expected.pixels = (cv::Mat_<float>(1, 2) << std::numeric_limits<float>::infinity(), 0.5F);
    actual.pixels = (cv::Mat_<float>(1, 2) << std::numeric_limits<float>::infinity(), 0.25F);
    const Comparison comparison = compare(expected, actual);
    EXPECT_EQ(comparison.max, 0.25);
    EXPECT_EQ(comparison.max_x, 1);
}

TEST(Compare, PicturesWithPaddedRowsCompareLikeOthers) {
    std::mt19937 random(3);
    const Image whole = random_image(40, 40, CV_8U, 4, random);
    Image part, copy;
    part.pixels = whole.pixels(cv::Rect(5, 6, 20, 21));
    copy.pixels = part.pixels.clone();
    EXPECT_TRUE(compare(part, copy).same);
}

TEST(Compare, EveryNumberOfThreadsGivesTheSameBits) {
    std::mt19937 random(11);
    const Image expected = random_image(90, 300, CV_32F, 3, random);
    const Image actual = changed_image(expected, CV_32F, 2, random);
    set_thread_count(4);
    const Comparison many = compare(expected, actual, {.threshold = 0.1});
    set_thread_count(1);
    const Comparison alone = compare(expected, actual, {.threshold = 0.1});
    set_thread_count(0);
    EXPECT_EQ(alone.mean, many.mean);
    EXPECT_EQ(alone.rmse, many.rmse);
    EXPECT_EQ(alone.reason, many.reason);
}

TEST(Compare, AThresholdOutsideTheUnitIntervalIsRefused) {
    const Image image = blank_image(1, 1, CV_8U, 1);
    for (double threshold : {-0.1, 1.1, static_cast<double>(kNan)}) {
        EXPECT_THROW(compare(image, image, {.threshold = threshold}), InvalidInput) << threshold;
        EXPECT_THROW(heat_map(image, image, {.threshold = threshold}), InvalidInput) << threshold;
    }
}

}  // namespace
}  // namespace puppetwarp::testing
