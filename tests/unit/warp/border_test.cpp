// Where a mesh ends, and pixels are covered in part.
#include "scenes.h"

#include <puppetwarp/warp/warp_job.h>

#include <gtest/gtest.h>

#include <cmath>

namespace puppetwarp::testing {
namespace {

Eigen::MatrixX2d turned(const Eigen::MatrixX2d& V, const Eigen::RowVector2d& centre, double degrees, double scale,
                        const Eigen::RowVector2d& shift) {
    const double angle = degrees * M_PI / 180;
    Eigen::Matrix2d A;
    A << std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle);
    return ((V.rowwise() - centre) * (scale * A)).rowwise() + (centre + shift);
}

double alpha_mass(const Image& image) {
    double sum = 0;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) sum += value_at(image, x, y, image.alpha_channel());
    }
    return sum / image.full_value();
}

// A photograph without alpha is a polygon when it is turned: its alpha weighs as much as that.
TEST(Border, AlphaOfATurnedPhotographWeighsAsMuchAsItsPolygon) {
    Random random(71);
    for (const int type : {CV_8UC1, CV_8UC3, CV_16UC3, CV_32FC3}) {
        const Image image = random_image(200, 150, type, random);
        const TriangleMesh rest = grid_mesh(0, 0, 200, 150, 9, 7, random);
        for (const double degrees : {0.3, 7.0, 30.0, 45.0, 133.0}) {
            for (const double scale : {0.31, 0.8, 1.0, 1.37}) {
                const Eigen::RowVector2d shift(uniform(random, -1, 1), uniform(random, -1, 1));
                const Eigen::MatrixX2d moved = turned(rest.V, {100, 75}, degrees, scale, shift);
                const Canvas canvas{-100, -120, 400, 390};
                for (const Interpolation interpolation : {Interpolation::bilinear, Interpolation::bicubic}) {
                    const Image result = warp(image, rest, moved, {interpolation, canvas});
                    const double area = 200 * 150 * scale * scale;
                    ASSERT_NEAR(alpha_mass(result), area, 0.001 * area) << degrees << ", " << scale;
                }
            }
        }
    }
}

// Each pixel on its own, by many samples.
TEST(Border, CoverageIsTheAreaWithinThePixel) {
    Random random(72);
    const Image image{cv::Mat(40, 60, CV_16UC1, cv::Scalar(1000)), {}};
    const TriangleMesh rest = grid_mesh(0, 0, 60, 40, 3, 2, random);
    const Eigen::MatrixX2d moved = turned(rest.V, {30, 20}, 17, 0.9, {0.3, -0.2});
    const Image result = warp(image, rest, moved, {Interpolation::bicubic, {-5, -5, 70, 50}});
    const Eigen::RowVector2d centre(30.3, 19.8);
    const Eigen::Vector2d right(std::cos(17 * M_PI / 180), std::sin(17 * M_PI / 180)), down(-right.y(), right.x());
    for (int y = 0; y < 50; ++y) {
        for (int x = 0; x < 70; ++x) {
            int inside = 0;
            for (int k = 0; k < 1024; ++k) {
                const Eigen::RowVector2d p(x - 5 + (k % 32 + 0.5) / 32, y - 5 + (k / 32 + 0.5) / 32);
                const double u = (p - centre) * right, v = (p - centre) * down;
                inside += std::abs(u) < 27 && std::abs(v) < 18;
            }
            ASSERT_NEAR(value_at(result, x, y, 1) / 65535, inside / 1024.0, 0.01) << x << ", " << y;
            const double colour = value_at(result, x, y, 1) == 0 ? 0 : 1000;
            ASSERT_EQ(value_at(result, x, y, 0), colour) << x << ", " << y;
        }
    }
}

class BorderFormats : public ::testing::TestWithParam<int> {};

// Also translucent ones, and where the picture shrinks: colours are divided by the alpha that they were multiplied by.
TEST_P(BorderFormats, ColourOfConstantPicturesIsConstantToTheBit) {
    Random random(73);
    for (const Interpolation interpolation : all_interpolations) {
        for (int round = 0; round < 24; ++round) {
            // Floats cannot be divided exactly: full alpha, or half.
            Image image = random_image(40, 30, GetParam(), random, round % 2 == 0 ? Alpha::opaque : Alpha::noise);
            const bool halves = image.pixels.depth() == CV_32F && image.has_alpha() && round % 2 == 1;
            if (halves) image.pixels.ptr<float>(0)[image.alpha_channel()] = 0.5F;
            if (image.has_alpha() && value_at(image, 0, 0, image.alpha_channel()) == 0) continue;
            for (int i = 0; i < 40 * 30; ++i) {
                std::memcpy(image.pixels.ptr(i / 40, i % 40), image.pixels.ptr(0, 0), image.pixels.elemSize());
            }
            const TriangleMesh rest = grid_mesh(0, 0, 40, 30, 3, 3, random);
            const double scale = std::array{1.0, 0.55, 3.0, 0.3, 1.2, 0.08}[static_cast<std::size_t>(round / 4)];
            const Eigen::MatrixX2d moved =
                turned(jittered(rest.V, 3, random), {20, 15}, uniform(random, 0, 360), scale, {0, 0});
            const bool linear = round % 4 >= 2;
            const Image result = warp(image, rest, moved, {interpolation, {-10, -12, 60, 50}, linear});
            for (int y = 0; y < 50; ++y) {
                for (int x = 0; x < 60; ++x) {
                    if (result.has_alpha() && value_at(result, x, y, result.alpha_channel()) == 0) continue;
                    for (int c = 0; c < (image.pixels.channels() <= 2 ? 1 : 3); ++c) {
                        ASSERT_EQ(value_at(result, x, y, c), value_at(image, 0, 0, c))
                            << x << ", " << y << ", " << scale << ", " << static_cast<int>(interpolation);
                    }
                }
            }
        }
    }
}

// The border of a mesh that moves by whole pixels lies between pixels, or cuts them as it did at rest.
TEST_P(BorderFormats, WholePixelMovesAreCopiesUpToTheLastPixel) {
    Random random(74);
    const Image image = random_image(37, 29, GetParam(), random, Alpha::noise);
    const TriangleMesh rest = grid_mesh(0, 0, 37, 29, 5, 4, random);
    for (const Interpolation interpolation : all_interpolations) {
        for (const auto& [dx, dy] : {std::pair{0, 0}, {5, -3}, {-20, 11}}) {
            const Eigen::MatrixX2d moved = jittered(rest.V.rowwise() + Eigen::RowVector2d(dx, dy), 1e-6, random);
            const Canvas all{dx, dy, 37, 29};
            EXPECT_TRUE(same_bytes(warp(image, rest, moved, {interpolation, all}).pixels, image.pixels));
        }
    }
}

INSTANTIATE_TEST_SUITE_P(AllFormats, BorderFormats, ::testing::ValuesIn(all_types), format_name);

// A triangle inside the mesh has no border, nor have the two sides of a cut that nobody opened.
TEST(Border, InnerEdgesAndClosedCutsDoNotShow) {
    Random random(75);
    const Image image{cv::Mat(30, 40, CV_8UC3, cv::Scalar(1, 2, 3)), {}};
    const TriangleMesh left = grid_mesh(0, 0, 20, 30, 3, 4, random), right = grid_mesh(20, 0, 40, 30, 3, 4, random);
    TriangleMesh cut;
    cut.V.resize(left.V.rows() + right.V.rows(), 2);
    cut.V << left.V, right.V;
    cut.F.resize(left.F.rows() + right.F.rows(), 3);
    cut.F << left.F, right.F.array() + static_cast<int>(left.V.rows());
    const Eigen::MatrixX2d moved = turned(cut.V, {20, 15}, 24, 1.1, {0.1, 0.2});
    const Image result = warp(image, cut, moved, {Interpolation::bicubic, {10, 5, 20, 20}});
    EXPECT_EQ(result.pixels.type(), CV_8UC3);
}

// Alpha rises evenly while a photograph is pushed over a pixel: nothing pops.
TEST(Border, CoverageFollowsASlowDrag) {
    Random random(76);
    const Image image{cv::Mat(20, 20, CV_8UC1, cv::Scalar(90)), {}};
    const TriangleMesh rest = grid_mesh(0, 0, 20, 20, 2, 2, random);
    for (double shift = 0.02; shift < 1; shift += 0.02) {
        const Eigen::MatrixX2d moved = rest.V.rowwise() + Eigen::RowVector2d(shift, 0);
        const Image result = warp(image, rest, moved, {Interpolation::bicubic, {-2, 0, 24, 20}});
        ASSERT_NEAR(value_at(result, 2, 10, 1), 255 * (1 - shift), 1) << shift;
        ASSERT_NEAR(value_at(result, 22, 10, 1), 255 * shift, 1) << shift;
        ASSERT_EQ(value_at(result, 1, 10, 1), 0);
        ASSERT_EQ(value_at(result, 3, 10, 1), 255);
    }
}

// A canvas that was rounded from a plane ends where the plane does.
TEST(Border, TheFrameEndsAPictureBetweenPixels) {
    Random random(77);
    const Image image = random_image(50, 30, CV_8UC3, random);
    const TriangleMesh rest = grid_mesh(0, 0, 50, 30, 2, 2, random);
    const Canvas own{0, 0, 50, 30};
    for (const double scale : {0.333, 0.77, 1.23, 2.017}) {
        const WarpOptions within{Interpolation::bicubic, scaled_canvas(own, scale, scale), false,
                                 scaled_frame(own, scale)};
        EXPECT_EQ(warp(image, rest, rest.V * scale, within).pixels.type(), CV_8UC3) << scale;
        // Turned it is not covered in the corners, whatever the frame.
        EXPECT_EQ(warp(image, rest, turned(rest.V * scale, {20, 15}, 5, 1, {0, 0}), within).pixels.type(), CV_8UC4);
    }
}

}  // namespace
}  // namespace puppetwarp::testing
