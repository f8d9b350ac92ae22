#include "quality.h"

#include <gtest/gtest.h>

namespace puppetwarp::testing {
namespace {

constexpr Interpolation filters[] = {Interpolation::bilinear, Interpolation::bicubic, Interpolation::lanczos3};

// A grey picture shrunk as a whole. Pixel (x, y) of the result is the square of side `factor` at (x, y) factor.
cv::Mat shrunk(const cv::Mat& picture, double factor, Interpolation interpolation) {
    Random random(1);
    const TriangleMesh rest = grid_mesh(0, 0, picture.cols, picture.rows, 1, 1, random);
    const Canvas canvas{0, 0, static_cast<int>(picture.cols / factor), static_cast<int>(picture.rows / factor)};
    return warp({picture, {}}, rest, rest.V / factor, {interpolation, canvas}).pixels;
}

// Against the exact mean of `scene`, of which a pixel of the result has sides of `factor`.
double against_means(const cv::Mat& result, const cv::Mat& scene, double factor) {
    return psnr(result, 3, [&](int x, int y) {
        return mean_in(scene, x * factor, y * factor, (x + 1) * factor, (y + 1) * factor);
    });
}

cv::Mat block_means(const cv::Mat& scene, int size) {
    cv::Mat means(scene.rows / size, scene.cols / size, CV_8UC1);
    for (int y = 0; y < means.rows; ++y) {
        for (int x = 0; x < means.cols; ++x) {
            const double mean = mean_in(scene, x * size, y * size, (x + 1) * size, (y + 1) * size);
            means.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(std::lround(mean));
        }
    }
    return means;
}

// The truth is what a pixel's square shows on average: of the source's uniform squares, and of a scene of which the
// source's pixels, as a camera's, are means.
TEST(WarpQuality, ShrinkingIsTheMeanOverThePixel) {
    Random random(61);
    const cv::Mat scene = natural_picture(2560, 1920, 8, random);
    const cv::Mat picture = block_means(scene, 4);
    for (const Interpolation interpolation : filters) {
        for (const double factor : {2.0, 2.7, 3.3, 4.0, 5.1, 7.9, 12.0}) {
            SCOPED_TRACE(interpolation_names()[static_cast<std::size_t>(interpolation)]);
            const cv::Mat result = shrunk(picture, factor, interpolation);
            EXPECT_GT(against_means(result, picture, factor), 50) << factor;
            EXPECT_GT(against_means(result, scene, 4 * factor), 50) << factor;
        }
    }
}

// Rings up to the finest that pixels can show: their moire would be new rings, of full contrast.
TEST(WarpQuality, ShrunkZonePlatesHaveNoMoire) {
    const cv::Mat plate = zone_plate(800);
    for (const Interpolation interpolation : filters) {
        SCOPED_TRACE(interpolation_names()[static_cast<std::size_t>(interpolation)]);
        for (const double factor : {8.0, 20.0}) {
            EXPECT_GT(against_means(shrunk(plate, factor, interpolation), plate, factor), 50) << factor;
        }
        for (const double factor : {8.3, 13.7, 20.6}) {
            EXPECT_GT(against_means(shrunk(plate, factor, interpolation), plate, factor), 36) << factor;
        }
    }
}

// v = a x + b y + c, of which the square of a pixel shows the value in its middle.
TEST(WarpQuality, RampsStayOnTheirPlaneWhereThePictureShrinks) {
    Random random(64);
    const auto value = [](double x, double y) { return 12 + 0.4 * x + 0.17 * y; };
    cv::Mat bytes(400, 400, CV_8UC1), words(400, 400, CV_16UC1);
    for (int y = 0; y < 400; ++y) {
        for (int x = 0; x < 400; ++x) {
            bytes.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(std::lround(value(x + 0.5, y + 0.5)));
            words.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(std::lround(200 * value(x + 0.5, y + 0.5)));
        }
    }
    const TriangleMesh rest = grid_mesh(0, 0, 400, 400, 3, 3, random);
    for (const Interpolation interpolation : filters) {
        for (const double factor : {0.37, 1.6, 2.7, 5.3, 9.1, 21.0}) {
            const int side = static_cast<int>(400 / factor);
            const int margin = static_cast<int>(std::ceil(40 / factor));
            const WarpOptions options{interpolation, {0, 0, side, side}};
            const Image eight = warp({bytes, {}}, rest, rest.V / factor, options);
            const Image sixteen = warp({words, {}}, rest, rest.V / factor, options);
            for (int y = margin; y < side - margin; ++y) {
                for (int x = margin; x < side - margin; ++x) {
                    const double expected = value((x + 0.5) * factor, (y + 0.5) * factor);
                    ASSERT_NEAR(value_at(eight, x, y, 0), expected, 1) << factor;
                    ASSERT_NEAR(value_at(sixteen, x, y, 0), 200 * expected, 1) << factor;
                }
            }
        }
    }
}

double contrast(const cv::Mat& picture) {
    double sum = 0, squares = 0;
    for (int y = 2; y < picture.rows - 2; ++y) {
        for (int x = 2; x < picture.cols - 2; ++x) {
            const double value = picture.at<std::uint8_t>(y, x);
            sum += value;
            squares += value * value;
        }
    }
    const double count = (picture.rows - 4.0) * (picture.cols - 4.0);
    return std::sqrt(squares / count - sum / count * (sum / count));
}

// Means of white noise have 1 / factor of its contrast, whoever computes them: no step where samples become more, nor
// where the pyramid takes over.
TEST(WarpQuality, BlurGrowsEvenlyWithShrinking) {
    Random random(62);
    Image noise = random_image(1600, 1600, CV_8UC1, random);
    for (const Interpolation interpolation : filters) {
        SCOPED_TRACE(interpolation_names()[static_cast<std::size_t>(interpolation)]);
        double before = 0;
        for (double factor = 7; factor < 10; factor += 0.13) {
            const double relative = contrast(shrunk(noise.pixels, factor, interpolation)) * factor;
            if (before > 0) {
                EXPECT_NEAR(relative / before, 1, 0.05) << factor;
            }
            before = relative;
        }
    }
}

TEST(WarpQuality, ShapesBlurWithoutAStepAtOneAndAHalf) {
    const cv::Mat plate = zone_plate(300);
    for (const Interpolation interpolation : filters) {
        const cv::Mat before = shrunk(plate, 1.4999999, interpolation), after = shrunk(plate, 1.5000001, interpolation);
        EXPECT_GT(psnr(after, 2, [&](int x, int y) { return before.at<std::uint8_t>(y, x); }), 50);
    }
}

TEST(WarpQuality, AWarpAndItsInverseLoseLittle) {
    Random random(63);
    for (const double finest_px : {2.0, 4.0}) {
        const cv::Mat picture = natural_picture(640, 480, finest_px, random);
        const TriangleMesh rest = grid_mesh(0, 0, 640, 480, 16, 12, random);
        Eigen::MatrixX2d moved = rest.V;
        for (Eigen::Index i = 0; i < moved.rows(); ++i) {
            const double x = rest.V(i, 0), y = rest.V(i, 1);
            moved(i, 0) += 20 * std::sin(y / 60) * std::sin(M_PI * x / 640);
            moved(i, 1) += 18 * std::cos(x / 50) * std::sin(M_PI * y / 480);
        }
        const auto there_and_back = [&](Interpolation interpolation) {
            const WarpOptions options{interpolation, {}};
            const Image there = warp({picture, {}}, rest, moved, options);
            const Image back = warp(there, {moved, rest.F}, rest.V, options);
            EXPECT_EQ(back.pixels.type(), CV_8UC1);
            return psnr(back.pixels, 0, [&](int x, int y) { return picture.at<std::uint8_t>(y, x); });
        };
        EXPECT_GT(there_and_back(Interpolation::bicubic), 38);
        EXPECT_GT(there_and_back(Interpolation::lanczos3), 42);
    }
}

}  // namespace
}  // namespace puppetwarp::testing
