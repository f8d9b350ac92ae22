#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/cutout/fill_behind.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <random>
#include <vector>

namespace puppetwarp {
namespace {

const std::vector<int> all_types{CV_8UC1,  CV_8UC2,  CV_8UC3,  CV_8UC4,  CV_16UC1, CV_16UC2,
                                 CV_16UC3, CV_16UC4, CV_32FC1, CV_32FC2, CV_32FC3, CV_32FC4};

using Shade = std::function<double(int x, int y, int channel)>;

//! A picture of values in [0, 1].
Image drawn(int width, int height, int type, const Shade& shade) {
    cv::Mat values(height, width, CV_MAKETYPE(CV_64F, CV_MAT_CN(type)));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < values.channels(); ++c)
                values.ptr<double>(y)[x * values.channels() + c] = shade(x, y, c);
        }
    }
    Image image;
    image.pixels.create(height, width, type);
    values.convertTo(image.pixels, CV_MAT_DEPTH(type), image.full_value());
    return image;
}

//! A disc of full coverage, its edge soft over `soft_px`.
Cutout disc(const Image& image, double x, double y, double radius, double soft_px = 1) {
    Cutout cutout;
    cutout.matte.create(image.pixels.size(), CV_8U);
    for (int j = 0; j < image.height(); ++j) {
        for (int i = 0; i < image.width(); ++i) {
            const double inside = (radius - std::hypot(i + 0.5 - x, j + 0.5 - y)) / soft_px + 0.5;
            cutout.matte.at<std::uint8_t>(j, i) = cv::saturate_cast<std::uint8_t>(255 * std::clamp(inside, 0.0, 1.0));
        }
    }
    return cutout;
}

Image filled(const Image& image, const Cutout& cutout) {
    Progress progress;
    return fill_behind(image, cutout, progress);
}

//! A channel as shares of full scale.
cv::Mat channel(const Image& image, int c) {
    cv::Mat result;
    cv::extractChannel(image.pixels, result, c);
    result.convertTo(result, CV_64F, 1 / image.full_value());
    return result;
}

bool same_bytes(const cv::Mat& a, const cv::Mat& b) {
    return a.size() == b.size() && a.type() == b.type() &&
           std::memcmp(a.data, b.data, a.total() * a.elemSize()) == 0;  // both own their pixels
}

class FillFormats : public testing::TestWithParam<int> {};

TEST_P(FillFormats, ConstantPicturesStayConstant) {
    const Image image = drawn(90, 70, GetParam(), [](int, int, int c) { return 0.2 + 0.2 * c; });
    const Image result = filled(image, disc(image, 40, 30, 18));
    const double most = image.pixels.depth() == CV_32F ? 1e-6 : image.pixels.depth() == CV_16U ? 2 / 65535.0 : 0;
    for (int c = 0; c < image.pixels.channels(); ++c) {
        EXPECT_LE(cv::norm(channel(result, c), channel(image, c), cv::NORM_INF), most + 1e-12) << c;
    }
}

TEST_P(FillFormats, OnlyTheSubjectAndALittleAroundItChanges) {
    std::mt19937 random(1);
    Image image = drawn(90, 70, GetParam(), [&](int, int, int) { return (random() % 1000 + 1) / 1000.0; });
    if (image.pixels.depth() == CV_32F) image.pixels.ptr<float>(2)[5] = std::numeric_limits<float>::quiet_NaN();
    image.metadata.icc = {1, 2, 3};
    const cv::Mat before = image.pixels.clone();
    const Image result = filled(image, disc(image, 40, 30, 12));
    EXPECT_EQ(result.metadata.icc, image.metadata.icc);
    EXPECT_EQ(std::memcmp(image.pixels.data, before.data, before.total() * before.elemSize()), 0);
    const std::size_t size = before.elemSize();
    int changed = 0;
    for (int y = 0; y < 70; ++y) {
        for (int x = 0; x < 90; ++x) {
            const bool same = std::memcmp(result.pixels.ptr(y, x), before.ptr(y, x), size) == 0;
            changed += !same;
            if (std::hypot(x + 0.5 - 40, y + 0.5 - 30) > 16) {
                ASSERT_TRUE(same) << x << ", " << y;
            }
        }
    }
    EXPECT_GT(changed, 400);
    cv::Mat numbers;
    result.pixels(cv::Rect(20, 10, 40, 40)).convertTo(numbers, CV_64F);
    EXPECT_TRUE(cv::checkRange(numbers));
}

// Stripes of a period of 12 go on behind the subject. A membrane alone would turn grey within a stripe's width.
TEST_P(FillFormats, TextureGoesOn) {
    const Shade stripes = [](int x, int y, int c) { return c == 3 ? 1.0 : 0.5 + 0.4 * std::sin((x + 2 * y) * 0.5); };
    const int channels = CV_MAT_CN(GetParam());
    const Shade shade = [&](int x, int y, int c) { return channels == 2 && c == 1 ? 1.0 : stripes(x, y, c); };
    const Image image = drawn(160, 120, GetParam(), shade);
    const Cutout cutout = disc(image, 80, 60, 20);
    Image covered{image.pixels.clone(), {}};
    covered.pixels.setTo(cv::Scalar::all(image.full_value()), cutout.matte > 0);
    const Image result = filled(covered, cutout);
    const cv::Mat difference = cv::abs(channel(result, 0) - channel(image, 0));
    EXPECT_LT(cv::mean(difference, cutout.matte > 0)[0], 0.08);
}

INSTANTIATE_TEST_SUITE_P(AllFormats, FillFormats, testing::ValuesIn(all_types), [](const auto& format) {
    const char* depth = CV_MAT_DEPTH(format.param) == CV_8U    ? "U8"
                        : CV_MAT_DEPTH(format.param) == CV_16U ? "U16"
                                                               : "F32";
    return std::string(depth) + "C" + std::to_string(CV_MAT_CN(format.param));
});

TEST(FillBehind, AnEdgeGoesOnStraight) {
    const Image image = drawn(200, 160, CV_8UC3, [](int x, int y, int) { return x + 2 * y < 260 ? 0.1 : 0.9; });
    const Cutout cutout = disc(image, 100, 80, 26);
    Image covered{image.pixels.clone(), {}};
    covered.pixels.setTo(cv::Scalar(0, 255, 0), cutout.matte > 0);
    const Image result = filled(covered, cutout);
    // Nothing but the two shades, but for a few pixels along the edge.
    const cv::Mat difference = cv::abs(channel(result, 0) - channel(image, 0));
    EXPECT_LT(cv::countNonZero(difference > 0.1), 26 * 2 * 4);
}

// The subject blurs into what is around it, farther than its matte says.
TEST(FillBehind, LeavesNoFringeOfTheSubject) {
    for (const double blur : {0.7, 1.2}) {
        Image image = drawn(300, 240, CV_8UC3, [](int x, int y, int c) {
            const bool subject = std::hypot(x + 0.5 - 150, y + 0.5 - 120) < 50;
            return subject ? (c == 0 ? 1.0 : 0.0) : 0.4;
        });
        cv::GaussianBlur(image.pixels, image.pixels, {}, blur);
        const Image result = filled(image, disc(image, 150, 120, 50));
        cv::Mat red = channel(result, 0) - channel(result, 1);
        double most = 0;
        cv::minMaxLoc(red, nullptr, &most);
        EXPECT_LE(most, 0.02) << blur;
    }
}

TEST(FillBehind, AlphaAroundTheSubjectGoesOn) {
    const Image image = drawn(120, 90, CV_8UC4, [](int, int y, int c) {
        return c == 3 ? 0.5 : c == 0 ? y / 90.0 : 0.25;
    });
    Image covered{image.pixels.clone(), {}};
    const Cutout cutout = disc(image, 60, 45, 20);
    covered.pixels.setTo(cv::Scalar::all(255), cutout.matte > 0);
    const Image result = filled(covered, cutout);
    EXPECT_LE(cv::norm(channel(result, 3), channel(image, 3), cv::NORM_INF), 1.01 / 255);
    EXPECT_LE(cv::norm(channel(result, 2), channel(image, 2), cv::NORM_INF), 1.01 / 255);
    EXPECT_LE(cv::norm(channel(result, 0), channel(image, 0), cv::NORM_INF), 0.15);
}

TEST(FillBehind, SubjectsAtTheBorderAndWithLittleAroundThemAreFilled) {
    const Image image = drawn(64, 48, CV_16UC3, [](int x, int, int c) { return x / 64.0 + 0.1 * c; });
    for (const auto& [x, y, radius] :
         {std::tuple(0.0, 0.0, 20.0), {64.0, 24.0, 30.0}, {32.0, 48.0, 25.0}, {32.0, 24.0, 34.0}, {32.0, 24.0, 0.4}}) {
        const Image result = filled(image, disc(image, x, y, radius));
        // What is filled in lies between what is around it, but for the few levels that take a seam away.
        for (int c = 0; c < 3; ++c) {
            double low = 0, high = 0;
            cv::minMaxLoc(channel(result, c), &low, &high);
            EXPECT_GE(low, 0.1 * c - 0.07);
            EXPECT_LE(high, 1 + 0.1 * c + 0.07);
        }
    }
    for (const auto& [width, height] : {std::pair{4, 4}, {1, 9}, {9, 1}, {30, 5}}) {
        Image tiny = drawn(width, height, CV_8UC1, [](int, int, int) { return 0.5; });
        Cutout one{false, cv::Mat(height, width, CV_8U, cv::Scalar(0))};
        one.matte.at<std::uint8_t>(0, 0) = 255;
        if (width * height > 9) {
            EXPECT_TRUE(same_bytes(filled(tiny, one).pixels, tiny.pixels)) << width << " x " << height;
        }
    }
}

TEST(FillBehind, SaysWhenThereIsNothingToFillFrom) {
    const Image opaque = drawn(40, 30, CV_8UC3, [](int x, int, int) { return x / 40.0; });
    EXPECT_THROW(filled(opaque, {true, {}}), InvalidInput);
    EXPECT_THROW(filled(opaque, {false, cv::Mat(30, 40, CV_8U, cv::Scalar(255))}), InvalidInput);
    EXPECT_THROW(filled(opaque, {false, cv::Mat(30, 40, CV_32F, cv::Scalar(0.01))}), InvalidInput);
    Image alone = drawn(40, 30, CV_8UC4, [](int, int, int) { return 0.0; });
    alone.pixels(cv::Rect(10, 10, 8, 8)).setTo(cv::Scalar::all(255));
    EXPECT_THROW(filled(alone, cut_out(alone)), InvalidInput);
}

TEST(FillBehind, GivesTheSameBytesForAnyNumberOfThreads) {
    std::mt19937 random(3);
    const Image image = drawn(200, 150, CV_8UC3, [&](int x, int y, int c) {
        return 0.4 + 0.3 * std::sin(x * 0.2 + c) * std::cos(y * 0.15) + (random() % 100) / 500.0;
    });
    const Cutout cutout = disc(image, 100, 70, 35);
    const int before = thread_count();
    set_thread_count(1);
    const Image expected = filled(image, cutout);
    for (const int threads : {2, 7}) {
        set_thread_count(threads);
        EXPECT_TRUE(same_bytes(filled(image, cutout).pixels, expected.pixels)) << threads;
    }
    set_thread_count(before);
}

// Above a million pixels around the subject: filled at a part of the size first.
Image large_picture(int type) {
    return drawn(1500, 1100, type, [](int x, int y, int c) {
        const double stripes = 0.5 + 0.3 * std::sin(2 * 3.14159265358979 * (x + 0.5 * y) / 48 + c);
        return c == 3 ? 1.0 : stripes + 0.1 * std::sin(0.9 * x) * std::sin(0.7 * y);
    });
}

TEST(FillBehind, LargeHolesAreFilledInFullDetail) {
    for (const int type : {CV_8UC3, CV_16UC4, CV_32FC1}) {
        Image image = large_picture(type);
        const Image empty{image.pixels.clone(), {}};
        const Cutout cutout = disc(image, 760, 540, 300);
        image.pixels.setTo(cv::Scalar::all(image.full_value()), cutout.matte > 0);
        const Image result = filled(image, cutout);
        cv::Mat hole, difference, detail;
        cv::dilate(cutout.matte > 0, hole, cv::Mat::ones(19, 19, CV_8U));  // 2 px and 1/250 of the diagonal
        const cv::Mat there = channel(result, 0), truth = channel(empty, 0);
        EXPECT_EQ(cv::norm(there, truth, cv::NORM_INF, hole == 0), 0);
        // Stripes go on where they were, to a fraction of their height (two unrelated ones differ by 0.3).
        EXPECT_LT(cv::norm(there, truth, cv::NORM_L2, hole) / std::sqrt(cv::countNonZero(hole)), 0.12) << type;
        // What is finer than the smaller picture knows is there too.
        const auto fine = [&](const cv::Mat& shown) {
            cv::Mat smooth;
            cv::blur(shown, smooth, {7, 7});
            return cv::norm(shown, smooth, cv::NORM_L2, hole);
        };
        EXPECT_GT(fine(there), 0.6 * fine(truth)) << type;
    }
}

TEST(FillBehind, LargeHolesGiveTheSameBytesForAnyNumberOfThreadsAndCanBeCancelledHalfway) {
    struct CancelledLate : Progress {
        bool cancelled() const override { return late; }
        void show(std::string_view stage, double fraction) override {
            EXPECT_EQ(stage, "background");
            EXPECT_GE(fraction, last);
            EXPECT_LE(fraction, 1);
            last = fraction;
            late |= fraction > 0.6;
        }
        double last = 0;
        bool late = false;
    } progress;
    const Image image = large_picture(CV_8UC3);
    const Cutout cutout = disc(image, 700, 500, 250);
    EXPECT_THROW(fill_behind(image, cutout, progress), Cancelled);
    const int before = thread_count();
    set_thread_count(1);
    const Image expected = filled(image, cutout);
    set_thread_count(3);
    EXPECT_TRUE(same_bytes(filled(image, cutout).pixels, expected.pixels));
    set_thread_count(before);
}

TEST(FillBehind, CanBeCancelled) {
    struct Cancelling : Progress {
        bool cancelled() const override { return true; }
    } progress;
    const Image image = drawn(60, 50, CV_8UC3, [](int x, int, int) { return x / 60.0; });
    EXPECT_THROW(fill_behind(image, disc(image, 30, 25, 10), progress), Cancelled);
}

}  // namespace
}  // namespace puppetwarp
