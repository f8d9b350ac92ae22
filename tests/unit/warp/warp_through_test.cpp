// Pictures drawn through maps: like the warp that a map was made of, and sensibly through any other.
#include "scenes.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/warp/displacement.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace puppetwarp::testing {
namespace {

constexpr float nowhere = std::numeric_limits<float>::quiet_NaN();

ThroughMapOptions through(Interpolation interpolation, double magnification = 1, Canvas canvas = {}) {
    return {interpolation, magnification, magnification, canvas};
}

// A map of one displacement everywhere.
DisplacementMap constant_map(int width, int height, double x, double y) {
    const cv::Scalar value(x, y, 1);
    return {{{0, 0, width, height}, 1, width, height}, cv::Mat(height, width, CV_32FC3, value)};
}

// What the largest difference is between the pixels of two pictures, where `counts(x, y)`; alpha counts for all.
template <class Counts>
double largest_difference(const Image& a, const Image& b, const Counts& counts) {
    EXPECT_EQ(a.pixels.type(), b.pixels.type());
    EXPECT_EQ(a.pixels.size(), b.pixels.size());
    if (a.pixels.type() != b.pixels.type() || a.pixels.size() != b.pixels.size()) return 1e9;
    double most = 0;
    for (int y = 0; y < a.height(); ++y) {
        for (int x = 0; x < a.width(); ++x) {
            if (!counts(x, y)) continue;
            for (int c = 0; c < a.pixels.channels(); ++c)
                most = std::max(most, std::abs(value_at(a, x, y, c) - value_at(b, x, y, c)));
        }
    }
    return most;
}

constexpr auto everywhere = [](int, int) { return true; };

// Whether the map is one plane around a pixel: no edge of a triangle comes near.
bool smooth_at(const DisplacementMap& map, int x, int y) {
    for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}}) {
        const auto at = [&](int k) {
            const int i = x + k * dx, j = y + k * dy;
            const bool inside = i >= 0 && j >= 0 && i < map.displacement.cols && j < map.displacement.rows;
            return inside ? map.displacement.at<cv::Vec3f>(j, i) : cv::Vec3f(nowhere, nowhere, 0);
        };
        const cv::Vec3f bend = at(-1) - 2 * at(0) + at(1);
        if (!(std::abs(bend[0]) < 1e-4 && std::abs(bend[1]) < 1e-4)) return false;
    }
    return true;
}

class ThroughFormats : public ::testing::TestWithParam<int> {};

TEST_P(ThroughFormats, GiveWhatTheWarpGives) {
    Random random(41);
    for (const Interpolation interpolation : {Interpolation::bilinear, Interpolation::bicubic}) {
        for (const Alpha alpha : {Alpha::opaque, Alpha::patches}) {
            const Image image = random_image(60, 45, GetParam(), random, alpha);
            const TriangleMesh rest = grid_mesh(0, 0, 60, 45, 3, 3, random);
            const Eigen::MatrixX2d moved = jittered(rest.V, 3, random);
            const WarpOptions options{interpolation, {-5, -4, 70, 55}};
            const Image direct = warp(image, rest, moved, options);
            const DisplacementMap map = displacement_map(image, rest, moved, options);
            const Image again = warp_through(image, map, through(interpolation));
            const double level = image.pixels.depth() == CV_8U ? 1 : image.pixels.depth() == CV_16U ? 16 : 2e-4;
            int compared = 0;
            const auto counts = [&](int x, int y) {
                // Where hardly anything is visible colour is badly determined.
                const bool visible =
                    !direct.has_alpha() || value_at(direct, x, y, direct.alpha_channel()) > 0.1 * direct.full_value();
                const bool chosen = visible && smooth_at(map, x, y);
                compared += chosen;
                return chosen;
            };
            EXPECT_LE(largest_difference(direct, again, counts), level);
            EXPECT_GT(compared, 600);
        }
    }
}

// `nearest` may decide for another pixel only where a place is as near to both.
TEST_P(ThroughFormats, GiveWhatTheWarpGivesToTheNearestPixel) {
    Random random(48);
    const Image image = random_image(60, 45, GetParam(), random, Alpha::opaque);
    const TriangleMesh rest = grid_mesh(0, 0, 60, 45, 3, 3, random);
    const WarpOptions options{Interpolation::nearest, {-5, -4, 70, 55}};
    const Eigen::MatrixX2d moved = jittered(rest.V, 3, random);
    const Image direct = warp(image, rest, moved, options);
    const Image again =
        warp_through(image, displacement_map(image, rest, moved, options), through(Interpolation::nearest));
    ASSERT_EQ(again.pixels.type(), direct.pixels.type());
    int other = 0;
    for (int y = 0; y < 55; ++y) {
        for (int x = 0; x < 70; ++x)
            other += std::memcmp(direct.pixels.ptr(y, x), again.pixels.ptr(y, x), direct.pixels.elemSize()) != 0;
    }
    EXPECT_LE(other, 2);
}

TEST_P(ThroughFormats, CopyPixelsForWholePixelMoves) {
    Random random(42);
    for (const Interpolation interpolation : all_interpolations) {
        const Image image = random_image(37, 29, GetParam(), random, Alpha::noise);
        const TriangleMesh rest = grid_mesh(-2, -2, 39, 31, 5, 4, random);
        for (const auto& [dx, dy] : {std::pair{0, 0}, {5, -3}, {-36, 2}}) {
            const Eigen::MatrixX2d moved = jittered(rest.V.rowwise() + Eigen::RowVector2d(dx, dy), 1e-6, random);
            // Beyond its border a picture without alpha goes on in one and ends in the other.
            const Canvas canvas{std::max(0, dx), std::max(0, dy), 37 - std::abs(dx), 29 - std::abs(dy)};
            const WarpOptions options{interpolation, canvas};
            const Image again =
                warp_through(image, displacement_map(image, rest, moved, options), through(interpolation));
            EXPECT_TRUE(same_bytes(again.pixels, warp(image, rest, moved, options).pixels)) << dx << ", " << dy;
        }
    }
}

TEST_P(ThroughFormats, ShrinkingTakesTheSamplesOfTheWarp) {
    Random random(43);
    const Image image = random_image(90, 70, GetParam(), random, Alpha::opaque);
    const TriangleMesh rest = grid_mesh(0, 0, 90, 70, 1, 1, random);
    for (const double scale : {0.6, 0.45, 0.3, 0.09}) {
        const Canvas canvas = scaled_canvas({0, 0, 90, 70}, scale, scale);
        const WarpOptions options{Interpolation::bicubic, canvas, false, scaled_frame({0, 0, 90, 70}, scale)};
        const DisplacementMap map = displacement_map(image, rest, rest.V * scale, options, scale);
        const double level = image.pixels.depth() == CV_8U ? 1 : image.pixels.depth() == CV_16U ? 16 : 2e-4;
        EXPECT_LE(largest_difference(warp(image, rest, rest.V * scale, options),
                                     warp_through(image, map, through(Interpolation::bicubic)), everywhere),
                  level)
            << scale;
    }
}

INSTANTIATE_TEST_SUITE_P(AllFormats, ThroughFormats, ::testing::ValuesIn(all_types), format_name);

// Made on a picture of a quarter of the size, drawn on the whole: affine maps lose nothing, to their very edges.
TEST(WarpThrough, MagnifiedMapsAreInterpolated) {
    Random random(44);
    const Image image = random_image(80, 60, CV_8UC3, random);
    const TriangleMesh rest = grid_mesh(0, 0, 80, 60, 1, 1, random);
    Eigen::Matrix2d A;
    A << 1.1, 0.2, -0.15, 0.95;
    const Eigen::MatrixX2d moved = rest.V * A;
    const Canvas small{-4, -4, 24, 22};
    const DisplacementMap map = displacement_map({cv::Mat(15, 20, CV_8UC3), {}}, {rest.V / 4, rest.F}, moved / 4,
                                                 {Interpolation::bicubic, small});
    const Image again = warp_through(image, map, through(Interpolation::bicubic, 4));
    const Image direct = warp(image, rest, moved, {Interpolation::bicubic, {-16, -16, 96, 88}});
    ASSERT_EQ(again.pixels.size(), cv::Size(96, 88));
    int different = 0, shown = 0;
    for (int y = 0; y < 88; ++y) {
        for (int x = 0; x < 96; ++x) {
            const cv::Vec4b a = again.pixels.at<cv::Vec4b>(y, x), b = direct.pixels.at<cv::Vec4b>(y, x);
            shown += b[3] == 255;
            different += a[3] != b[3];
            if (a[3] != b[3]) continue;
            for (int c = 0; c < 3; ++c) ASSERT_NEAR(a[c], b[c], 1) << x << ", " << y;
        }
    }
    EXPECT_GT(shown, 3500);
    EXPECT_LT(different, 350);  // along the outline, which a quarter of the pixels know of
}

TEST(WarpThrough, ATearStaysATear) {
    // The left half shows the picture's left edge region, the right half what lies 60 further: red, then blue.
    Image image{cv::Mat(20, 100, CV_8UC3, cv::Scalar(0, 255, 0)), {}};
    image.pixels.colRange(0, 20).setTo(cv::Scalar(255, 0, 0));
    image.pixels.colRange(80, 100).setTo(cv::Scalar(0, 0, 255));
    DisplacementMap map = constant_map(20, 10, 0, 0);
    map.plane.source_width = 100;
    map.plane.source_height = 20;
    map.displacement.colRange(10, 20).setTo(cv::Scalar(80, 0, 1));
    for (const double magnification : {1.0, 3.0, 4.5}) {
        const Image result = warp_through(image, map, through(Interpolation::bilinear, magnification));
        for (int x = 0; x < result.width(); ++x) {
            const cv::Vec3b pixel = result.pixels.at<cv::Vec3b>(3, x);
            const double from_tear = (x + 0.5) / magnification - 10;
            ASSERT_EQ(pixel, from_tear < 0 ? cv::Vec3b(255, 0, 0) : cv::Vec3b(0, 0, 255)) << x;
        }
    }
}

TEST(WarpThrough, WhatIsNoPlaceOrNotInThePictureShowsNothing) {
    const Image image{cv::Mat(10, 10, CV_8UC3, cv::Scalar(7, 8, 9)), {}};
    DisplacementMap map = constant_map(10, 10, 0, 0);
    const float infinity = std::numeric_limits<float>::infinity();
    const cv::Vec3f odd[] = {{nowhere, 0, 1}, {0, nowhere, 1}, {infinity, 0, 1}, {0, -infinity, 1}, {1e30F, 0, 1},
                             {0, -3e38F, 1},  {20, 0, 1},      {0, -6.1F, 1},    {0, 0, 0}};
    for (int k = 0; k < 9; ++k) map.displacement.at<cv::Vec3f>(5, k) = odd[k];
    for (const double magnification : {1.0, 2.0}) {
        const Image result = warp_through(image, map, through(Interpolation::bicubic, magnification));
        ASSERT_EQ(result.pixels.type(), CV_8UC4);
        const int m = static_cast<int>(magnification);
        for (int x = 0; x < 9 * m; ++x) {
            if (m == 1 || x / m == 8) continue;  // half shown by its neighbours
            ASSERT_EQ(result.pixels.at<cv::Vec4b>(5 * m + m / 2, x)[3] == 255, false) << x;
        }
        ASSERT_EQ(result.pixels.at<cv::Vec4b>(2 * m, 2 * m), cv::Vec4b(7, 8, 9, 255));
    }
    EXPECT_EQ(warp_through(image, constant_map(10, 10, 0, 0)).pixels.type(), CV_8UC3);
    EXPECT_EQ(warp_through(image, constant_map(10, 10, 0.3, 0)).pixels.type(), CV_8UC3);
    EXPECT_EQ(warp_through(image, constant_map(10, 10, 1.2, 0)).pixels.type(), CV_8UC4);
}

TEST(WarpThrough, WhatIsPartlyShownIsTranslucent) {
    for (const int type : {CV_8UC3, CV_16UC4, CV_32FC2}) {
        Random random(45);
        const Image image = random_image(6, 4, type, random, Alpha::opaque);
        DisplacementMap map = constant_map(6, 4, 0, 0);
        map.displacement.at<cv::Vec3f>(1, 2)[2] = 0.25F;
        const Image result = warp_through(image, map);
        ASSERT_TRUE(result.has_alpha());
        EXPECT_NEAR(value_at(result, 2, 1, result.alpha_channel()) / result.full_value(), 0.25, 0.002);
        EXPECT_EQ(value_at(result, 2, 1, 0), value_at(image, 2, 1, 0));
        EXPECT_EQ(value_at(result, 3, 1, result.alpha_channel()), result.full_value());
    }
}

TEST(WarpThrough, CanvasBeyondTheMapIsEmpty) {
    const Image image{cv::Mat(10, 10, CV_8UC3, cv::Scalar(7, 8, 9)), {}};
    const Image result =
        warp_through(image, constant_map(10, 10, 0, 0), through(Interpolation::bicubic, 1, {-3, -2, 20, 15}));
    ASSERT_EQ(result.pixels.size(), cv::Size(20, 15));
    EXPECT_EQ(result.pixels.at<cv::Vec4b>(2, 2), cv::Vec4b(0, 0, 0, 0));
    EXPECT_EQ(result.pixels.at<cv::Vec4b>(2, 3), cv::Vec4b(7, 8, 9, 255));
    EXPECT_EQ(result.pixels.at<cv::Vec4b>(11, 12), cv::Vec4b(7, 8, 9, 255));
    EXPECT_EQ(result.pixels.at<cv::Vec4b>(12, 12), cv::Vec4b(0, 0, 0, 0));
}

TEST(WarpThrough, GivesTheSameBytesForAnyNumberOfThreads) {
    Random random(46);
    const int before = thread_count();
    const Image image = random_image(150, 131, CV_8UC4, random, Alpha::patches);
    const TriangleMesh rest = grid_mesh(-2, -2, 152, 133, 9, 7, random);
    const DisplacementMap map = displacement_map(image, rest, jittered(rest.V, 9, random));
    set_thread_count(1);
    const Image expected = warp_through(image, map, through(Interpolation::bicubic, 1.7));
    for (const int threads : {2, 7}) {
        set_thread_count(threads);
        EXPECT_TRUE(same_bytes(warp_through(image, map, through(Interpolation::bicubic, 1.7)).pixels, expected.pixels));
    }
    set_thread_count(before);
}

TEST(WarpThrough, RefusesWhatDoesNotFitTogether) {
    const Image image{cv::Mat(10, 10, CV_8UC3, cv::Scalar(7, 8, 9)), {}};
    EXPECT_THROW(warp_through(image, DisplacementMap()), InvalidInput);
    DisplacementMap map = constant_map(10, 10, 0, 0);
    EXPECT_THROW(warp_through(image, map, through(Interpolation::bicubic, 0)), InvalidInput);
    EXPECT_THROW(warp_through(image, map, through(Interpolation::bicubic, nowhere)), InvalidInput);
    EXPECT_THROW(warp_through(image, map, through(Interpolation::bicubic, 1e6)), InvalidInput);
    EXPECT_THROW(warp_through(image, map, through(Interpolation::bicubic, 0.01)), InvalidInput);
    map.plane.canvas.width = 9;
    EXPECT_THROW(warp_through(image, map), InvalidInput);
}

TEST(ScaledCanvas, HoldsThePixelsWhoseCentresLieInIt) {
    const auto expect = [](const Canvas& canvas, double x_scale, double y_scale, const Canvas& wanted) {
        const Canvas scaled = scaled_canvas(canvas, x_scale, y_scale);
        EXPECT_EQ(scaled.x, wanted.x);
        EXPECT_EQ(scaled.y, wanted.y);
        EXPECT_EQ(scaled.width, wanted.width);
        EXPECT_EQ(scaled.height, wanted.height);
    };
    expect({-7, 3, 101, 33}, 1, 1, {-7, 3, 101, 33});
    expect({-7, 3, 101, 33}, 2, 3, {-14, 9, 202, 99});
    expect({0, 0, 101, 33}, 0.5, 0.5, {0, 0, 50, 16});  // the centre of pixel 50 lies on the edge at 50.5: not in it
    expect({0, 0, 100, 100}, 1.0 / 3, 2.0 / 3, {0, 0, 33, 67});
    expect({-1, -1, 2, 2}, 0.5, 0.5, {-1, -1, 1, 1});
    EXPECT_THROW(scaled_canvas({0, 0, 100, 100}, 0.001, 1), InvalidInput);
    EXPECT_THROW(scaled_canvas({0, 0, 100, 100}, 1e9, 1), InvalidInput);
    EXPECT_THROW(scaled_canvas({0, 0, 100, 100}, 1000, 1000), InvalidInput);
    EXPECT_THROW(scaled_canvas({0, 0, 100, 100}, nowhere, 1), InvalidInput);
}

// Whole pictures keep having no alpha at any scale: every pixel is covered.
TEST(ScaledCanvas, IsCoveredByTheScaledPicture) {
    Random random(47);
    for (int round = 0; round < 300; ++round) {
        const int width = 1 + static_cast<int>(random() % 60), height = 1 + static_cast<int>(random() % 60);
        const double scale = uniform(random, 0.5, 3) + 0.5 / width;
        const Image image{cv::Mat(height, width, CV_8UC1, cv::Scalar(7)), {}};
        const TriangleMesh rest = grid_mesh(0, 0, width, height, 1, 1, random);
        const Canvas canvas = scaled_canvas({0, 0, width, height}, scale, scale);
        const WarpOptions options{Interpolation::bilinear, canvas, false, scaled_frame({0, 0, width, height}, scale)};
        ASSERT_EQ(warp(image, rest, rest.V * scale, options).pixels.type(), CV_8UC1)
            << width << " x " << height << " at " << scale;
    }
}

}  // namespace
}  // namespace puppetwarp::testing
