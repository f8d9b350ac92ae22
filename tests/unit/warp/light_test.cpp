// Linear light, where the warp's reference does not reach: tables, backgrounds, pyramids, maps.
#include "scenes.h"

#include <puppetwarp/warp/background.h>
#include <puppetwarp/warp/displacement.h>
#include <puppetwarp/warp/light.h>

#include <gtest/gtest.h>

#include <cmath>

namespace puppetwarp::testing {
namespace {

double srgb_encoded(double light) {
    return light <= 0.0031308 ? light * 12.92 : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
}

TEST(LightTables, GiveEachValueBack) {
    for (const int type : {CV_8UC1, CV_16UC3}) {
        const Image image{cv::Mat(1, 1, type, cv::Scalar::all(0)), {}};
        const detail::LightTables tables(image);
        const int full = static_cast<int>(image.full_value());
        for (int value = 0; value <= full; ++value) {
            ASSERT_EQ(tables.encode(0, tables.decode(0)[value]), value);
            ASSERT_TRUE(value == 0 || tables.decode(0)[value] > tables.decode(0)[value - 1]) << value;
        }
        EXPECT_EQ(tables.encode(0, -1), 0);
        EXPECT_EQ(tables.encode(0, static_cast<float>(2 * full)), full);
        EXPECT_EQ(tables.encode(0, std::nanf("")), 0);
    }
}

// To the nearest value, by the formula of IEC 61966-2-1.
TEST(LightTables, RoundToTheNearestValue) {
    Random random(91);
    const Image image{cv::Mat(1, 1, CV_16UC1, cv::Scalar::all(0)), {}};
    const detail::LightTables tables(image);
    for (int round = 0; round < 100000; ++round) {
        const double light = std::pow(uniform(random, 0, 1), 3);
        ASSERT_NEAR(tables.encode(0, static_cast<float>(light * 65535)), srgb_encoded(light) * 65535, 0.6) << light;
    }
}

TEST(LinearLight, HalfWhiteOverBlackIsHalfOfTheLight) {
    for (const int type : {CV_8UC4, CV_16UC4, CV_8UC2}) {
        Image front{cv::Mat(1, 1, type, cv::Scalar::all(0)), {}};
        const double full = front.full_value();
        cv::Scalar white = cv::Scalar::all(full);
        white[front.alpha_channel()] = std::floor(full / 2 + 1);
        front.pixels.setTo(white);
        const Image original{cv::Mat(1, 1, type, cv::Scalar(0, 0, 0, full)), {}};
        const Background black{Background::Kind::colour, {0, 0, 0, 1}};
        const double share = white[front.alpha_channel()] / full;
        EXPECT_NEAR(value_at(lay_over(black, front, original, {0, 0, 1, 1}, true), 0, 0, 0), full * srgb_encoded(share),
                    1);
        EXPECT_NEAR(value_at(lay_over(black, front, original, {0, 0, 1, 1}, false), 0, 0, 0), full * share, 1);
    }
}

// Stripes of black and white, shrunk by a pyramid, by a map too.
TEST(LinearLight, IsAveragedByPyramidsAndThroughMaps) {
    Random random(92);
    for (const int type : {CV_8UC3, CV_16UC1}) {
        Image image{cv::Mat(400, 400, type, cv::Scalar::all(0)), {}};
        for (int y = 0; y < 400; y += 2) image.pixels.row(y).setTo(cv::Scalar::all(image.full_value()));
        const TriangleMesh rest = grid_mesh(0, 0, 400, 400, 2, 2, random);
        for (const double scale : {0.25, 0.05}) {
            const int side = static_cast<int>(400 * scale);
            const WarpOptions options{Interpolation::bicubic, {0, 0, side, side}, true};
            const Image result = warp(image, rest, rest.V * scale, options);
            const double expected = image.full_value() * srgb_encoded(0.5);
            EXPECT_NEAR(value_at(result, side / 2, side / 2, 0), expected, 0.01 * image.full_value()) << scale;
            ThroughMapOptions through;
            through.linear = true;
            const Image again = warp_through(image, displacement_map(image, rest, rest.V * scale, options), through);
            EXPECT_NEAR(value_at(again, side / 2, side / 2, 0), expected, 0.01 * image.full_value()) << scale;
        }
    }
}

// Floats are light already.
TEST(LinearLight, LeavesFloatsAlone) {
    Random random(93);
    const Image image = random_image(30, 30, CV_32FC3, random);
    const TriangleMesh rest = grid_mesh(0, 0, 30, 30, 3, 3, random);
    const Eigen::MatrixX2d moved = jittered(rest.V, 2, random);
    EXPECT_TRUE(same_bytes(warp(image, rest, moved, {Interpolation::bicubic, {}, true}).pixels,
                           warp(image, rest, moved, {Interpolation::bicubic, {}, false}).pixels));
}

}  // namespace
}  // namespace puppetwarp::testing
