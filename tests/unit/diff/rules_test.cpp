// For each rule a pair that it alone decides.

#include "random_images.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <puppetwarp/base/errors.h>
#include <puppetwarp/diff/compare.h>
#include <puppetwarp/diff/mask.h>
#include <puppetwarp/diff/summary.h>
#include <opencv2/core.hpp>

#include "support/message_of.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace puppetwarp::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A flat grey picture, and one in which some pixels are brighter by some levels.
class Rules : public ::testing::Test {
protected:
    Rules() : expected(blank_image(40, 30, CV_8U, 3)) {
        expected.pixels.setTo(cv::Scalar::all(100));
        actual.pixels = expected.pixels.clone();
    }

    void brighten(int x, int y, int levels) { actual.pixels.at<cv::Vec3b>(y, x) += cv::Vec3b::all(levels); }
    bool same(const CompareOptions& options = {}) const { return compare(expected, actual, options).same; }
    std::vector<std::string> failed(const CompareOptions& options) const {
        return compare(expected, actual, options).failed;
    }

    Image expected;
    Image actual;
};

TEST_F(Rules, ByDefaultOneLevelOfOneChannelFails) {
    actual.pixels.at<cv::Vec3b>(29, 39)[2] += 1;
    EXPECT_FALSE(same());
    EXPECT_THAT(failed({}), ElementsAre("threshold"));
}

TEST_F(Rules, ThresholdIsOfTheLargestChannel) {
    actual.pixels.at<cv::Vec3b>(3, 4) = {103, 105, 100};
    EXPECT_TRUE(same({.threshold = 5 / 255.0}));
    EXPECT_FALSE(same({.threshold = 4 / 255.0}));
}

TEST_F(Rules, FailPixelsAllowsAsManyAndNotOneMore) {
    for (int i = 0; i < 3; ++i) brighten(10 * i, 5, 50);
    EXPECT_TRUE(same({.fail_pixels = 3}));
    EXPECT_FALSE(same({.fail_pixels = 2}));
    EXPECT_THAT(failed({.fail_pixels = 2}), ElementsAre("fail-pixels"));
    EXPECT_THAT(compare(expected, actual, {.fail_pixels = 1}).reason, HasSubstr("allowed is 1"));
}

TEST_F(Rules, FailPercentIsOfTheComparedPixels) {
    for (int i = 0; i < 12; ++i) brighten(i, 5, 50);  // 1 % of 1200
    EXPECT_TRUE(same({.fail_percent = 1}));
    EXPECT_FALSE(same({.fail_percent = 0.99}));
    EXPECT_THAT(failed({.fail_percent = 0.5}), ElementsAre("fail-percent"));
    EXPECT_FALSE(same({.fail_percent = 1, .ignore = {{0, 20, 40, 10}}}));  // 12 of 800
    EXPECT_FALSE(same({.fail_pixels = 11, .fail_percent = 1}));
    EXPECT_THAT(failed({.fail_pixels = 11, .fail_percent = 0.5}), ElementsAre("fail-pixels", "fail-percent"));
}

TEST_F(Rules, HardFailLooksAtEveryPixel) {
    brighten(3, 3, 20);
    brighten(5, 5, 60);
    EXPECT_TRUE(same({.fail_pixels = 2}));
    EXPECT_TRUE(same({.fail_pixels = 2, .hard_fail = 60 / 255.0}));
    EXPECT_THAT(failed({.fail_pixels = 2, .hard_fail = 59 / 255.0}), ElementsAre("hard-fail"));
    EXPECT_TRUE(same({.fail_pixels = 2, .hard_fail = 59 / 255.0, .ignore = {{5, 5, 1, 1}}}));
}

TEST_F(Rules, RmseIsOfTheWholePicture) {
    brighten(3, 3, 51);  // 0.2 in 1 of 1200 pixels
    const double rmse = 0.2 / std::sqrt(1200.0);
    EXPECT_TRUE(same({.metric = DiffMetric::rmse, .threshold = rmse * 1.001}));
    EXPECT_FALSE(same({.metric = DiffMetric::rmse, .threshold = rmse * 0.999}));
    EXPECT_FALSE(same({.metric = DiffMetric::rmse}));
}

TEST_F(Rules, PsnrIsALeastNumberOfDecibels) {
    brighten(3, 3, 51);
    const double psnr = -20 * std::log10(0.2 / std::sqrt(1200.0));
    EXPECT_TRUE(same({.metric = DiffMetric::psnr, .threshold = psnr - 0.01}));
    EXPECT_FALSE(same({.metric = DiffMetric::psnr, .threshold = psnr + 0.01}));
    EXPECT_FALSE(same({.metric = DiffMetric::psnr}));
    EXPECT_TRUE(compare(expected, expected, {.metric = DiffMetric::psnr}).same);
}

TEST_F(Rules, SsimIsALeastSimilarityAndAloneDecides) {
    brighten(20, 15, 60);
    const double ssim = compare(expected, actual, {.metric = DiffMetric::ssim}).ssim.value();
    ASSERT_LT(ssim, 0.99);
    EXPECT_TRUE(same({.metric = DiffMetric::ssim, .threshold = ssim - 0.001}));
    EXPECT_FALSE(same({.metric = DiffMetric::ssim, .threshold = ssim + 0.001}));
    EXPECT_FALSE(same({.metric = DiffMetric::ssim}));
    // --min-ssim alone
    EXPECT_TRUE(same({.min_ssim = ssim - 0.001}));
    EXPECT_THAT(failed({.min_ssim = ssim + 0.001}), ElementsAre("min-ssim"));
    EXPECT_EQ(deciding_metric({.min_ssim = 0.9}), DiffMetric::ssim);
    // beside other rules it is one more
    EXPECT_TRUE(same({.threshold = 60 / 255.0, .min_ssim = ssim - 0.001}));
    EXPECT_THAT(failed({.threshold = 60 / 255.0, .min_ssim = ssim + 0.001}), ElementsAre("min-ssim"));
    EXPECT_THAT(failed({.threshold = 59 / 255.0, .min_ssim = ssim - 0.001}), ElementsAre("threshold"));
    EXPECT_EQ(deciding_metric({.fail_pixels = 3, .min_ssim = 0.9}), DiffMetric::max);
}

TEST_F(Rules, FlipCountsPixels) {
    brighten(20, 15, 60);
    const Comparison seen = compare(expected, actual, {.metric = DiffMetric::flip});
    EXPECT_GT(seen.differing_pixels, 1);  // an eye sees it around, too
    EXPECT_EQ(seen.max_x, 20);
    EXPECT_TRUE(same({.metric = DiffMetric::flip, .threshold = seen.flip_max}));
    EXPECT_FALSE(same({.metric = DiffMetric::flip, .threshold = seen.flip_max * 0.99}));
    EXPECT_TRUE(same({.metric = DiffMetric::flip, .fail_pixels = seen.differing_pixels}));
    EXPECT_FALSE(same({.metric = DiffMetric::flip, .fail_pixels = seen.differing_pixels - 1}));
}

TEST_F(Rules, ASeamFailsTheWindowAndAsManyScatteredPixelsDoNot) {
    for (int i = 0; i < 12; ++i) brighten(3 * i, (7 * i) % 30, 2);
    EXPECT_TRUE(same({.threshold = 4 / 255.0, .window_px = 8}));
    EXPECT_TRUE(same({.fail_pixels = 20, .window_px = 8}));
    for (int y = 10; y < 18; ++y) brighten(25, y, 2);
    const CompareOptions options{.threshold = 4 / 255.0, .window_px = 8};
    EXPECT_THAT(failed(options), ElementsAre("window"));
    const Comparison comparison = compare(expected, actual, options);
    EXPECT_GE(comparison.window_pixels, 8);
    EXPECT_EQ(comparison.differing_pixels, 0);
    EXPECT_TRUE(same({.threshold = 4 / 255.0, .window_px = 8, .window_threshold = 2 / 255.0}));
    EXPECT_TRUE(same({.threshold = 4 / 255.0}));
    EXPECT_FALSE(same({.metric = DiffMetric::rmse, .threshold = 0.5, .window_px = 8}));
    EXPECT_FALSE(same({.metric = DiffMetric::flip, .threshold = 0.9, .window_px = 8}));
}

TEST_F(Rules, TheDensestWindowIsThatOfAPlainCount) {
    std::mt19937 random(2);
    for (const int side : {1, 3, 7, 29, 100}) {
        actual.pixels = expected.pixels.clone();
        for (int i = 0; i < 60; ++i) {
            actual.pixels.at<cv::Vec3b>(static_cast<int>(random() % 30), static_cast<int>(random() % 40)) = {0, 0, 0};
        }
        int most = 0, at_x = -1, at_y = -1;
        for (int top = 0; top + std::min(side, 30) <= 30; ++top) {
            for (int left = 0; left + std::min(side, 40) <= 40; ++left) {
                int count = 0;
                for (int y = top; y < std::min(30, top + side); ++y) {
                    for (int x = left; x < std::min(40, left + side); ++x) {
                        count += actual.pixels.at<cv::Vec3b>(y, x) != expected.pixels.at<cv::Vec3b>(y, x);
                    }
                }
                if (count <= most) continue;
                most = count;
                at_x = left;
                at_y = top;
            }
        }
        const Comparison comparison = compare(expected, actual, {.window_px = side});
        EXPECT_EQ(comparison.window_pixels, most) << side;
        EXPECT_EQ(comparison.window_x, at_x) << side;
        EXPECT_EQ(comparison.window_y, at_y) << side;
    }
}

TEST_F(Rules, MaskAndIgnoredRectanglesTakePixelsOut) {
    brighten(10, 10, 90);
    brighten(30, 20, 30);
    EXPECT_FALSE(same({.ignore = {{8, 8, 5, 5}}}));
    EXPECT_TRUE(same({.ignore = {{8, 8, 5, 5}, {30, 20, 100, 100}}}));
    cv::Mat mask(30, 40, CV_8U, cv::Scalar(255));
    mask(cv::Rect(0, 0, 20, 30)).setTo(0);
    const Comparison comparison = compare(expected, actual, {.mask = mask});
    EXPECT_EQ(comparison.max_x, 30);
    EXPECT_EQ(comparison.compared_pixels, 600);
    EXPECT_NEAR(comparison.differing_percent, 100.0 / 600, 1e-12);
    EXPECT_NEAR(comparison.mean, 30.0 / 255 / 600, 1e-12);
    EXPECT_TRUE(same({.mask = mask, .ignore = {{-5, 15, 100, 100}}}));
}

TEST_F(Rules, AMaskPictureIsWhiteWhereComparedAndBlackOrTransparentElsewhere) {
    Image picture = blank_image(4, 1, CV_8U, 4);
    picture.pixels.at<cv::Vec4b>(0, 0) = {255, 255, 255, 255};
    picture.pixels.at<cv::Vec4b>(0, 1) = {255, 255, 255, 0};
    picture.pixels.at<cv::Vec4b>(0, 2) = {0, 0, 0, 255};
    picture.pixels.at<cv::Vec4b>(0, 3) = {130, 130, 130, 255};
    const cv::Mat mask = comparison_mask(picture);
    const std::vector<std::uint8_t> values(mask.begin<std::uint8_t>(), mask.end<std::uint8_t>());
    EXPECT_THAT(values, ElementsAre(1, 0, 0, 1));
}

TEST_F(Rules, MaskOfAnotherSizeRectanglesOutsideAndNothingLeftAreRefused) {
    const auto complaint = [&](const CompareOptions& options) {
        return message_of([&] { compare(expected, actual, options); });
    };
    EXPECT_THAT(complaint({.mask = cv::Mat::ones(30, 41, CV_8U)}), HasSubstr("41 x 30"));
    EXPECT_THAT(complaint({.mask = cv::Mat::ones(30, 40, CV_16U)}), HasSubstr("mask"));
    EXPECT_THAT(complaint({.ignore = {{40, 0, 5, 5}}}), HasSubstr("outside"));
    EXPECT_THAT(complaint({.ignore = {{-9, 0, 9, 5}}}), HasSubstr("outside"));
    EXPECT_THAT(complaint({.ignore = {{3, 3, 0, 5}}}), HasSubstr("empty"));
    constexpr int most = std::numeric_limits<int>::max();
    EXPECT_THAT(complaint({.ignore = {{0, 0, most, most}}}), HasSubstr("nothing to compare"));
    EXPECT_THAT(complaint({.ignore = {{39, 29, most, most}}}), "");
    EXPECT_THAT(complaint({.mask = cv::Mat::zeros(30, 40, CV_8U)}), HasSubstr("nothing to compare"));
}

TEST_F(Rules, AlphaStraightPremultipliedOrIgnored) {
    Image a = blank_image(3, 1, CV_8U, 4), b = blank_image(3, 1, CV_8U, 4);
    b.pixels.at<cv::Vec4b>(0, 0) = {9, 99, 9, 0};  // a colour where it is invisible
    EXPECT_FALSE(compare(a, b).same);
    EXPECT_TRUE(compare(a, b, {.alpha = AlphaRule::premultiplied}).same);
    EXPECT_FALSE(compare(a, b, {.alpha = AlphaRule::ignore}).same);
    b.pixels.at<cv::Vec4b>(0, 0) = {0, 0, 0, 77};  // alpha alone
    EXPECT_FALSE(compare(a, b).same);
    EXPECT_FALSE(compare(a, b, {.alpha = AlphaRule::premultiplied}).same);
    EXPECT_TRUE(compare(a, b, {.alpha = AlphaRule::ignore}).same);
    // half the colour at half the alpha: 100 * 128 / 255 against 200 * 128 / 255
    a.pixels.at<cv::Vec4b>(0, 1) = {100, 0, 0, 128};
    b.pixels.at<cv::Vec4b>(0, 1) = {200, 0, 0, 128};
    b.pixels.at<cv::Vec4b>(0, 0) = {0, 0, 0, 0};
    EXPECT_NEAR(compare(a, b, {.alpha = AlphaRule::premultiplied}).max, 100.0 / 255 * 128 / 255, 1e-5);
    EXPECT_NEAR(compare(a, b).max, 100.0 / 255, 1e-12);
}

TEST_F(Rules, WithoutAlphaAPictureThatHasNoneCompares) {
    Image with = blank_image(5, 5, CV_8U, 4), without = blank_image(5, 5, CV_16U, 3);
    EXPECT_THAT(compare(with, without).failed, ElementsAre("channels"));
    EXPECT_TRUE(compare(with, without, {.alpha = AlphaRule::ignore}).same);
    EXPECT_TRUE(compare(without, with, {.alpha = AlphaRule::ignore}).same);
    without.pixels.at<cv::Vec3w>(2, 3)[1] = 65535;
    const Comparison comparison = compare(with, without, {.alpha = AlphaRule::ignore});
    EXPECT_EQ(comparison.max, 1);
    EXPECT_EQ(comparison.max_x, 3);
    EXPECT_EQ(comparison.max_channel, 1);
}

TEST_F(Rules, PremultipliedFloatsAreInvisibleUnderNoAlphaEvenAsNan) {
    Image a = blank_image(2, 1, CV_32F, 4), b = blank_image(2, 1, CV_32F, 4);
    b.pixels.at<cv::Vec4f>(0, 0)[1] = std::numeric_limits<float>::quiet_NaN();
    b.pixels.at<cv::Vec4f>(0, 0)[2] = std::numeric_limits<float>::infinity();
    EXPECT_FALSE(compare(a, b).same);
    EXPECT_TRUE(compare(a, b, {.alpha = AlphaRule::premultiplied}).same);
}

TEST_F(Rules, MetadataCountsOnlyOnDemand) {
    actual.metadata.icc = {1, 2, 3};
    actual.metadata.xmp = {1};
    EXPECT_TRUE(same());
    const Comparison comparison = compare(expected, actual, {.metadata = true});
    EXPECT_FALSE(comparison.same);
    EXPECT_THAT(comparison.failed, ElementsAre("metadata"));
    EXPECT_THAT(comparison.metadata,
                ElementsAre("the ICC profile differs: expected none, actual 3 bytes", HasSubstr("XMP differs")));
    expected.metadata = actual.metadata;
    EXPECT_TRUE(same({.metadata = true}));
    expected.metadata.icc = {1, 2, 4};
    expected.metadata.exif = {5};
    expected.metadata.x_pixels_per_mm = expected.metadata.y_pixels_per_mm = 11.811;
    EXPECT_EQ(compare(expected, actual, {.metadata = true}).metadata.size(), 3);
    actual.metadata = expected.metadata;
    actual.metadata.x_pixels_per_mm = 300 / 25.4;  // as another file format rounds 300 a inch
    EXPECT_TRUE(same({.metadata = true}));
}

TEST_F(Rules, NumbersOutsideTheirRangeAreRefused) {
    const auto complaint = [&](const CompareOptions& options) {
        return message_of([&] { compare(expected, actual, options); });
    };
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    for (const double bad : {-0.01, 1.01, nan, infinity}) {
        EXPECT_THAT(complaint({.threshold = bad}), HasSubstr("threshold")) << bad;
        EXPECT_THAT(complaint({.metric = DiffMetric::flip, .threshold = bad}), HasSubstr("threshold")) << bad;
        EXPECT_THAT(complaint({.metric = DiffMetric::rmse, .threshold = bad}), HasSubstr("threshold")) << bad;
        EXPECT_THAT(complaint({.metric = DiffMetric::ssim, .threshold = bad}), HasSubstr("threshold")) << bad;
        EXPECT_THAT(complaint({.hard_fail = bad}), HasSubstr("hard-fail")) << bad;
        EXPECT_THAT(complaint({.min_ssim = bad}), HasSubstr("min-ssim")) << bad;
        EXPECT_THAT(complaint({.window_threshold = bad}), HasSubstr("window-threshold")) << bad;
        EXPECT_THAT(complaint({.fail_percent = 100 * bad}), HasSubstr("fail-percent")) << bad;
    }
    for (const double bad : {-1.0, nan, infinity}) {
        EXPECT_THAT(complaint({.metric = DiffMetric::psnr, .threshold = bad}), HasSubstr("threshold")) << bad;
    }
    EXPECT_THAT(complaint({.fail_pixels = -1}), HasSubstr("fail-pixels"));
    EXPECT_THAT(complaint({.window_px = -1}), HasSubstr("window"));
    EXPECT_THAT(complaint({.shift_px = 1000}), HasSubstr("shift"));
    EXPECT_THAT(complaint({.pixels_per_degree = 0}), HasSubstr("ppd"));
}

TEST_F(Rules, RulesForPixelsAndMetricsOfThePictureDoNotGoTogether) {
    for (const DiffMetric metric : {DiffMetric::rmse, DiffMetric::psnr, DiffMetric::ssim}) {
        EXPECT_THROW(compare(expected, actual, {.metric = metric, .fail_pixels = 1}), InvalidInput);
        EXPECT_THROW(compare(expected, actual, {.metric = metric, .fail_percent = 1}), InvalidInput);
        EXPECT_THROW(compare(expected, actual, {.metric = metric, .antialiasing = true}), InvalidInput);
    }
}

TEST_F(Rules, NamesOfMetricsComeBack) {
    for (const char* name : {"max", "rmse", "psnr", "ssim", "flip"}) {
        EXPECT_EQ(diff_metric_name(diff_metric_from_name(name)), name);
    }
    EXPECT_THAT(message_of([] { diff_metric_from_name("mse"); }), HasSubstr("max, rmse, psnr, ssim, flip"));
    EXPECT_EQ(alpha_rule_from_name("ignore"), AlphaRule::ignore);
    EXPECT_THROW(alpha_rule_from_name("none"), InvalidInput);
}

TEST_F(Rules, TheSummarySpeaksTheWordsOfIdiff) {
    EXPECT_EQ(summary(compare(expected, actual)), "same\n");
    actual.pixels.at<cv::Vec3b>(20, 30)[1] = 151;
    const std::string different = summary(compare(expected, actual));
    EXPECT_THAT(different, HasSubstr("different: 1 pixel differs"));
    EXPECT_THAT(different, HasSubstr("Mean error = "));
    EXPECT_THAT(different, HasSubstr("RMS error = "));
    EXPECT_THAT(different, HasSubstr("Peak SNR = "));
    EXPECT_THAT(different, HasSubstr("Max error  = 0.2 @ (30, 20) in G  values are 0.392157, 0.392157, 0.392157 vs "
                                     "0.392157, 0.592157, 0.392157\n"));
    EXPECT_THAT(different, HasSubstr("1 pixels (0.0833333 %) over 0\n"));
    EXPECT_THAT(summary(compare(expected, actual, {.fail_pixels = 1})), HasSubstr("same: within the limits\n"));
}

TEST_F(Rules, WithoutALimitSsimPassesNoDifferenceThatItDoesNotShow) {
    expected = blank_image(40, 30, CV_8U, 4);  // invisible: SSIM sees the same in both
    actual.pixels = expected.pixels.clone();
    EXPECT_TRUE(same({.metric = DiffMetric::ssim}));
    actual.pixels.at<cv::Vec4b>(20, 30)[1] = 51;
    ASSERT_EQ(compare(expected, actual, {.metric = DiffMetric::ssim}).ssim, 1);
    EXPECT_THAT(failed({.metric = DiffMetric::ssim}), ElementsAre("threshold"));
    EXPECT_THAT(compare(expected, actual, {.metric = DiffMetric::ssim}).reason,
                HasSubstr("SSIM is 1, but a pixel differs by 0.2 of full scale at 30,20"));
    EXPECT_TRUE(same({.metric = DiffMetric::ssim, .threshold = 1}));
    EXPECT_TRUE(same({.metric = DiffMetric::ssim, .alpha = AlphaRule::premultiplied}));
    EXPECT_TRUE(same({.min_ssim = 1}));
}

TEST_F(Rules, NumbersThatDifferLittleReadDifferently) {
    actual.pixels.at<cv::Vec3b>(20, 30)[1] = 151;  // off by 51 of 255, of one channel of one of 1200 pixels
    const double least_over = std::nextafter(51 / 255.0, 0);
    const auto reason = [&](const CompareOptions& options) { return compare(expected, actual, options).reason; };
    EXPECT_THAT(reason({.threshold = least_over}), HasSubstr("by more than 0.19999999999999998 "));
    EXPECT_THAT(reason({.threshold = least_over}), HasSubstr("by up to 0.20000000000000001 of full scale"));
    EXPECT_THAT(reason({.fail_pixels = 1, .hard_fail = 0.19999999}),
                ::testing::EndsWith("differs by 0.2 of full scale at 30,20, over the hard limit of 0.19999999"));
    EXPECT_THAT(reason({.fail_percent = 0.083333}), HasSubstr("(0.0833333 %)"));
    EXPECT_THAT(reason({.fail_percent = 0.08333332}), HasSubstr("(0.08333333 %)"));
    EXPECT_THAT(reason({.fail_percent = 0.08333332}), HasSubstr("allowed are 0.08333332 %"));

    actual.pixels = expected.pixels.clone();
    actual.pixels.at<cv::Vec3b>(20, 30)[0] += 1;
    const std::string trace = reason({.metric = DiffMetric::ssim});
    EXPECT_THAT(trace, HasSubstr("SSIM is 0.99999"));
    EXPECT_THAT(trace, ::testing::EndsWith("under the limit of 1"));

    expected.pixels.convertTo(expected.pixels, CV_16U, 257);
    actual.pixels = expected.pixels.clone();
    actual.pixels.at<cv::Vec3w>(20, 30)[1] += 1;
    EXPECT_THAT(summary(compare(expected, actual)),
                HasSubstr("values are 0.392157, 0.392157, 0.392157 vs 0.392157, 0.392172, 0.392157"));
    actual.pixels.convertTo(actual.pixels, CV_32F, 1 / 65535.0);
    actual.pixels.at<cv::Vec3f>(20, 30) = cv::Vec3f(0.3921569F, 0.39215693F, 0.3921569F);
    const std::string summed = summary(compare(expected, actual));
    EXPECT_THAT(summed, HasSubstr(" vs "));
    EXPECT_THAT(summed, ::testing::Not(HasSubstr("values are 0.392157, 0.392157, 0.392157 vs 0.392157, 0.392157,")));
}

TEST_F(Rules, OnePixelIsAPictureToEveryMetric) {
    Image one = blank_image(1, 1, CV_8U, 3), other = blank_image(1, 1, CV_8U, 3);
    other.pixels.setTo(cv::Scalar::all(255));
    for (const char* name : {"max", "rmse", "psnr", "ssim", "flip"}) {
        const CompareOptions options{.metric = diff_metric_from_name(name), .window_px = 5, .shift_px = 3};
        EXPECT_TRUE(compare(one, one, options).same) << name;
        EXPECT_FALSE(compare(one, other, options).same) << name;
    }
    EXPECT_FALSE(compare(one, other, {.antialiasing = true}).same);
}

}  // namespace
}  // namespace puppetwarp::testing
