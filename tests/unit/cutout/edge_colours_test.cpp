#include <puppetwarp/cutout/edge_colours.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

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

//! Without alpha.
cv::Mat colours(const Image& image) {
    std::vector<cv::Mat> channels;
    cv::split(image.pixels, channels);
    if (image.has_alpha()) channels.pop_back();
    cv::Mat merged;
    cv::merge(channels, merged);
    return merged;
}

bool same_bytes(const cv::Mat& a, const cv::Mat& b) {
    return a.type() == b.type() && a.size() == b.size() && std::memcmp(a.data, b.data, a.total() * a.elemSize()) == 0;
}

//! How far colours on the edge are from the subject's own, weighted by what of them shows: the largest halo that a new
//! background makes visible.
double worst_halo(const Image& image, double soft_px) {
    double worst = 0;
    cv::Mat values;
    colours(image).convertTo(values, CV_64F, 1 / image.full_value());
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
            const Image clean = apply_clean_cutout(image, cutout_of(soft_px, depth));
            const double before = worst_halo(image, soft_px);
            EXPECT_GT(before, 0.1);
            EXPECT_LT(worst_halo(clean, soft_px), 0.35 * before) << soft_px << " px soft";
        }
    }
}

TEST_P(EdgeFormats, WhatIsCoveredInFullOrNotAtAllStays) {
    const Image image = seen(GetParam(), 2);
    const cv::Mat before = image.pixels.clone();
    const Image cut = apply_cutout(image, cutout_of(2, CV_8U));
    const Image clean = apply_clean_cutout(image, cutout_of(2, CV_8U));
    EXPECT_TRUE(same_bytes(image.pixels, before));
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const double a = coverage(x, y, 2);
            if (a > 0 && a < 1) continue;
            ASSERT_EQ(std::memcmp(clean.pixels.ptr(y, x), cut.pixels.ptr(y, x), cut.pixels.elemSize()), 0)
                << x << ", " << y;
        }
    }
}

// Cutouts do not know how far a camera mixes both sides: whatever the mixture, what remains is the subject's.
TEST_P(EdgeFormats, ColoursStayBetweenThoseOfTheSubjectNearBy) {
    Image image = seen(GetParam(), 3);
    const int channels = image.pixels.channels();
    cv::Mat values;
    image.pixels.convertTo(values, CV_64F);
    cv::RNG random(7);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const double a = coverage(x, y, 3), mixture = random.uniform(0.0, 1.0);
            if (!(a > 0 && a < 1)) continue;
            for (int c = 0; c < channels; ++c) {
                values.ptr<double>(y)[x * channels + c] =
                    image.full_value() * (mixture * subject(x, y, c) + (1 - mixture) * behind(x, y, c));
            }
        }
    }
    values.convertTo(image.pixels, image.pixels.depth());
    colours(apply_clean_cutout(image, cutout_of(3, CV_16U))).convertTo(values, CV_64F, 1 / image.full_value());
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const double a = coverage(x, y, 3);
            if (!(a > 0 && a < 0.9)) continue;
            for (int c = 0; c < channels; ++c) {
                ASSERT_NEAR(values.ptr<double>(y)[x * channels + c], 0.8 - 0.25 * c, 0.09) << x << ", " << y;
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Formats, EdgeFormats,
                         testing::Values(CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3, CV_32FC1, CV_32FC3));

// Soft as a brush's border, and one that cuts through what is the same on both sides: no mixture there.
// Work is shared out by bands of rows: where these end must not show.
TEST(CleanEdges, MoveWithThePicture) {
    const Image image = seen(CV_8UC3, 3);
    const Cutout cutout = cutout_of(3, CV_8U);
    const Image here = apply_clean_cutout(image, cutout);
    for (const int down : {1, 23, 40, 63}) {
        Image moved;
        Cutout moved_cutout;
        cv::copyMakeBorder(image.pixels, moved.pixels, down, 0, 0, 0, cv::BORDER_REPLICATE);
        cv::copyMakeBorder(cutout.matte, moved_cutout.matte, down, 0, 0, 0, cv::BORDER_CONSTANT);
        const Image there = apply_clean_cutout(moved, moved_cutout);
        EXPECT_TRUE(same_bytes(there.pixels.rowRange(down, down + size).clone(), here.pixels)) << down;
    }
}

TEST(CleanEdges, WideSoftBordersAndUniformPlacesStay) {
    const Image image = seen(CV_8UC3, 1);
    const Cutout wide = cutout_of(24, CV_8U), narrow = cutout_of(2, CV_8U);
    EXPECT_TRUE(same_bytes(apply_clean_cutout(image, wide).pixels, apply_cutout(image, wide).pixels));
    const Image flat{cv::Mat(size, size, CV_8UC3, cv::Scalar(90, 120, 40)), {}};
    EXPECT_TRUE(same_bytes(apply_clean_cutout(flat, narrow).pixels, apply_cutout(flat, narrow).pixels));
}

TEST(CleanEdges, PicturesWithTheirOwnAlphaAndWholeOnesStay) {
    Image own{cv::Mat(size, size, CV_8UC4, cv::Scalar(10, 20, 30, 255)), {}};
    own.pixels.colRange(0, 50).setTo(cv::Scalar(200, 100, 0, 255));
    const Cutout cutout = cutout_of(2, CV_8U);
    EXPECT_TRUE(same_bytes(apply_clean_cutout(own, cutout).pixels, apply_cutout(own, cutout).pixels));
    const Image image = seen(CV_8UC3, 2);
    EXPECT_EQ(apply_clean_cutout(image, {true, {}}).pixels.data, image.pixels.data);
}

TEST(CleanEdges, NumbersThatAreNoneDoNoHarm) {
    Image image = seen(CV_32FC3, 2);
    for (int y = 0; y < size; y += 3) {
        image.pixels.ptr<float>(y)[3 * 20 + 1] = std::numeric_limits<float>::quiet_NaN();
        image.pixels.ptr<float>(y)[3 * 99] = std::numeric_limits<float>::infinity();
    }
    const Image clean = apply_clean_cutout(image, cutout_of(2, CV_8U));
    // A pixel whose surroundings are no numbers keeps its own colour.
    const cv::Mat kept = colours(clean);
    for (int y = 0; y < size; ++y) {
        for (int i = 0; i < 3 * size; ++i) {
            if (std::isfinite(image.pixels.ptr<float>(y)[i])) {
                ASSERT_TRUE(std::isfinite(kept.ptr<float>(y)[i])) << i / 3 << ", " << y;
            }
        }
    }
}

}  // namespace
}  // namespace puppetwarp
