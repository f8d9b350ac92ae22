#include <puppetwarp/cutout/edge_colours.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace puppetwarp {
namespace {

constexpr int size = 120;

double coverage(int x, int y, double soft_px) {
    return std::clamp((40 - std::hypot(x + 0.5 - 60, y + 0.5 - 60)) / soft_px + 0.5, 0.0, 1.0);
}

// The subject and what is behind it, both with a little shading, as shares of full scale.
double subject(int x, int y, int c) {
    return 0.8 - 0.25 * c + 0.04 * std::sin(0.3 * x) + 0.03 * std::cos(0.2 * y);
}
double behind(int x, int y, int c) {
    return 0.1 + 0.3 * c + 0.03 * std::cos(0.25 * x + 0.1 * y);
}

//! Both mixed by coverage, as a camera sees them.
Image seen(int type, double soft_px) {
    cv::Mat values(size, size, CV_MAKETYPE(CV_64F, CV_MAT_CN(type)));
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const double a = coverage(x, y, soft_px);
            for (int c = 0; c < values.channels(); ++c) {
                values.ptr<double>(y)[x * values.channels() + c] = a * subject(x, y, c) + (1 - a) * behind(x, y, c);
            }
        }
    }
    Image image;
    image.pixels.create(size, size, type);
    values.convertTo(image.pixels, CV_MAT_DEPTH(type), image.full_value());
    return image;
}

Cutout cutout_of(double soft_px, int depth) {
    Cutout cutout;
    cv::Mat matte(size, size, CV_64F);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) matte.at<double>(y, x) = coverage(x, y, soft_px);
    }
    matte.convertTo(cutout.matte, depth, depth == CV_8U ? 255 : depth == CV_16U ? 65535 : 1);
    return cutout;
}

//! How far colours on the edge are from the subject's own, weighted by what of them shows: the largest halo that a new
//! background makes visible.
double worst_halo(const Image& image, double soft_px) {
    double worst = 0;
    cv::Mat values;
    image.pixels.convertTo(values, CV_64F, 1 / image.full_value());
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const double a = coverage(x, y, soft_px);
            for (int c = 0; c < values.channels(); ++c) {
                const double off = values.ptr<double>(y)[x * values.channels() + c] - subject(x, y, c);
                worst = std::max(worst, a * std::abs(off));
            }
        }
    }
    return worst;
}

class EdgeFormats : public testing::TestWithParam<int> {};

TEST_P(EdgeFormats, NothingOfTheOldBackgroundComesAlong) {
    for (const double soft_px : {1.0, 2.0, 3.0}) {
        for (const int depth : {CV_8U, CV_16U, CV_32F}) {
            const Image image = seen(GetParam(), soft_px);
            const Image clean = with_clean_edges(image, cutout_of(soft_px, depth));
            const double before = worst_halo(image, soft_px);
            EXPECT_GT(before, 0.1);
            EXPECT_LT(worst_halo(clean, soft_px), 0.35 * before) << soft_px << " px soft";
        }
    }
}

TEST_P(EdgeFormats, WhatIsCoveredInFullOrNotAtAllStays) {
    const Image image = seen(GetParam(), 2);
    const cv::Mat before = image.pixels.clone();
    const Image clean = with_clean_edges(image, cutout_of(2, CV_8U));
    EXPECT_EQ(std::memcmp(image.pixels.data, before.data, before.total() * before.elemSize()), 0);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const double a = coverage(x, y, 2);
            if (a > 0 && a < 1) continue;
            ASSERT_EQ(std::memcmp(clean.pixels.ptr(y, x), before.ptr(y, x), before.elemSize()), 0) << x << ", " << y;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Formats, EdgeFormats,
                         testing::Values(CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3, CV_32FC1, CV_32FC3));

// Soft as a brush's border, and one that cuts through what is the same on both sides: no mixture there.
TEST(CleanEdges, WideSoftBordersAndUniformPlacesStay) {
    const Image image = seen(CV_8UC3, 1);
    const Image wide = with_clean_edges(image, cutout_of(24, CV_8U));
    EXPECT_EQ(cv::norm(wide.pixels, image.pixels, cv::NORM_INF), 0);
    const Image flat{cv::Mat(size, size, CV_8UC3, cv::Scalar(90, 120, 40)), {}};
    EXPECT_EQ(cv::norm(with_clean_edges(flat, cutout_of(2, CV_8U)).pixels, flat.pixels, cv::NORM_INF), 0);
}

TEST(CleanEdges, PicturesWithTheirOwnAlphaAndWholeOnesStay) {
    Image own{cv::Mat(size, size, CV_8UC4, cv::Scalar(10, 20, 30, 255)), {}};
    own.pixels.colRange(0, 50).setTo(cv::Scalar(200, 100, 0, 255));
    EXPECT_EQ(with_clean_edges(own, cutout_of(2, CV_8U)).pixels.data, own.pixels.data);
    const Image image = seen(CV_8UC3, 2);
    EXPECT_EQ(with_clean_edges(image, {true, {}}).pixels.data, image.pixels.data);
}

TEST(CleanEdges, NumbersThatAreNoneDoNoHarm) {
    Image image = seen(CV_32FC3, 2);
    for (int y = 0; y < size; y += 3) {
        image.pixels.ptr<float>(y)[3 * 20 + 1] = std::numeric_limits<float>::quiet_NaN();
        image.pixels.ptr<float>(y)[3 * 99] = std::numeric_limits<float>::infinity();
    }
    const Image clean = with_clean_edges(image, cutout_of(2, CV_8U));
    // A pixel whose surroundings are no numbers keeps its own colour.
    for (int y = 0; y < size; ++y) {
        for (int i = 0; i < 3 * size; ++i) {
            if (std::isfinite(image.pixels.ptr<float>(y)[i])) {
                ASSERT_TRUE(std::isfinite(clean.pixels.ptr<float>(y)[i])) << i / 3 << ", " << y;
            }
        }
    }
}

}  // namespace
}  // namespace puppetwarp
