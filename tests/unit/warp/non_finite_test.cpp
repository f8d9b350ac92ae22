// Float pictures that hold what is no number, and positions from which no number comes back.
#include "scenes.h"

#include <puppetwarp/warp/displacement.h>
#include <puppetwarp/warp/warp_job.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace puppetwarp::testing {
namespace {

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

class NonFinite : public ::testing::TestWithParam<int> {};

int reach_of(Interpolation interpolation) {
    return interpolation == Interpolation::nearest    ? 1
           : interpolation == Interpolation::bilinear ? 1
           : interpolation == Interpolation::bicubic  ? 2
                                                      : 3;
}

// Every channel of one pixel in turn. What lies further away than the filter reaches is as if it were a number.
TEST_P(NonFinite, SpreadsNoFurtherThanTheFilterReaches) {
    Random random(81);
    const TriangleMesh rest = grid_mesh(0, 0, 61, 53, 5, 4, random);
    for (const Interpolation interpolation : all_interpolations) {
        for (const double scale : {1.0, 2.3, 0.43, 0.09}) {
            for (const float bad : {nan_value, infinity, -infinity}) {
                const Eigen::MatrixX2d moved = jittered(rest.V * scale, 0.5 * scale, random);
                const Canvas canvas{-2, -2, static_cast<int>(61 * scale) + 4, static_cast<int>(53 * scale) + 4};
                Image image = random_image(61, 53, GetParam(), random, Alpha::patches);
                const Image good = warp(image, rest, moved, {interpolation, canvas});
                const int channel = static_cast<int>(random() % static_cast<unsigned>(image.pixels.channels()));
                image.pixels.ptr<float>(27)[31 * image.pixels.channels() + channel] = bad;
                const Image result = warp(image, rest, moved, {interpolation, canvas});
                ASSERT_EQ(result.pixels.type(), good.pixels.type());
                // Levels of the pyramid reach as far as their pixels are large.
                const double level = scale < 0.1 ? 2 : 1;
                const double reach = (level * (reach_of(interpolation) + 1) * 1.5 + 1 / scale) * scale * 1.3 + 2;
                for (int y = 0; y < result.height(); ++y) {
                    for (int x = 0; x < result.width(); ++x) {
                        const double dx = x - 1.5 - 31.5 * scale, dy = y - 1.5 - 27.5 * scale;
                        if (std::max(std::abs(dx), std::abs(dy)) <= reach) continue;
                        for (int c = 0; c < result.pixels.channels(); ++c) {
                            ASSERT_EQ(value_at(result, x, y, c), value_at(good, x, y, c)) << x << ", " << y;
                        }
                    }
                }
            }
        }
    }
}

// The same bytes also for pictures full of it; alpha is a number everywhere.
TEST_P(NonFinite, DoesNoHarmInAnyNumber) {
    Random random(82);
    const TriangleMesh rest = grid_mesh(-2, -2, 42, 32, 4, 4, random);
    for (int round = 0; round < 40; ++round) {
        Image image = random_image(40, 30, GetParam(), random, Alpha::noise);
        const int values = 40 * image.pixels.channels();
        for (int k = 0; k < 300; ++k) {
            const float bad[] = {nan_value, infinity, -infinity, 3e38F, -3e38F, 1e-42F};
            image.pixels.ptr<float>(static_cast<int>(random() % 30))[random() % static_cast<unsigned>(values)] =
                bad[random() % 6];
        }
        const double scale = std::array{1.0, 0.4, 0.07, 2.0}[static_cast<std::size_t>(round % 4)];
        const Eigen::MatrixX2d moved = jittered(rest.V * scale, 3 * scale, random);
        const WarpOptions options{all_interpolations[round / 4 % 4], {-3, -3, 50, 40}, round % 3 == 0};
        Progress progress;
        const Image result = warp(image, rest, moved, options);
        const Image scalar = detail::warp_with(detail::Simd::scalar, image, rest, moved, options, progress);
        for (int y = 0; y < result.height(); ++y) {
            for (int x = 0; x < result.width(); ++x) {
                for (int c = 0; c < result.pixels.channels(); ++c) {
                    const double a = value_at(result, x, y, c), b = value_at(scalar, x, y, c);
                    ASSERT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << x << ", " << y << ": " << a << ", " << b;
                }
                // The nearest pixel is a copy, whatever it holds.
                if (!result.has_alpha() || options.interpolation == Interpolation::nearest) continue;
                const double alpha = value_at(result, x, y, result.alpha_channel());
                ASSERT_TRUE(alpha >= 0 && alpha <= 1) << alpha;
            }
        }
        const DisplacementMap map = displacement_map(image, rest, moved, options);
        EXPECT_NO_THROW(warp_through(image, map));
    }
}

INSTANTIATE_TEST_SUITE_P(FloatFormats, NonFinite, ::testing::Values(CV_32FC1, CV_32FC2, CV_32FC3, CV_32FC4),
                         format_name);

// A triangle drawn out to where numbers end: what of it is on the canvas is a colour of the picture.
TEST(WarpToInfinity, PixelsNearbyStayThePicturesOwn) {
    Random random(83);
    for (const double far : {1e4, 1e7, 1e9, 1e12, 1e300}) {
        for (const Interpolation interpolation : all_interpolations) {
            const Image image{cv::Mat(40, 40, CV_8UC3, cv::Scalar(7, 100, 200)), {}};
            const TriangleMesh rest = grid_mesh(0, 0, 40, 40, 2, 2, random);
            Eigen::MatrixX2d moved = rest.V;
            moved.row(8) << far, far;
            moved.row(2) << far, -far;
            moved.row(6) << -far, far;
            const Image result = warp(image, rest, moved, {interpolation, {}});
            for (int y = 0; y < 40; ++y) {
                for (int x = 0; x < 40; ++x) {
                    if (result.has_alpha() && value_at(result, x, y, 3) == 0) continue;
                    ASSERT_EQ(value_at(result, x, y, 0), 7) << x << ", " << y << ", " << far;
                    ASSERT_EQ(value_at(result, x, y, 2), 200) << x << ", " << y << ", " << far;
                }
            }
        }
    }
}

}  // namespace
}  // namespace puppetwarp::testing
