#include <puppetwarp/project/weight_colours.h>

#include "reference/test_meshes.h"

#include <opencv2/core.hpp>

#include <gtest/gtest.h>

#include <cstdlib>

namespace puppetwarp {
namespace {

// ColorBrewer's YlOrRd of 9 classes, its first colour made white.
TEST(WeightColours, AreThoseOfTheRampFromNoneToAll) {
    EXPECT_EQ(weight_colour(0), (Rgb{255, 255, 255}));
    EXPECT_EQ(weight_colour(0.25), (Rgb{254, 217, 118}));
    EXPECT_EQ(weight_colour(0.5), (Rgb{253, 141, 60}));
    EXPECT_EQ(weight_colour(0.75), (Rgb{227, 26, 28}));
    EXPECT_EQ(weight_colour(1), (Rgb{128, 0, 38}));
    // Half way between white and (255, 243, 178).
    const Rgb between = weight_colour(1.0 / 16);
    EXPECT_EQ(between[0], 255);
    EXPECT_EQ(between[1], 249);
    EXPECT_NEAR(between[2], 216.5, 0.5);
}

TEST(WeightColours, DarkenAllTheWayInside) {
    double lighter = 256;
    for (int step = 0; step <= 100; ++step) {
        const Rgb rgb = weight_colour(step / 100.0);
        const double luma = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
        EXPECT_LT(luma, lighter) << step;
        lighter = luma;
    }
}

TEST(WeightColours, TellWhatIsBelowNoneAndAboveAll) {
    const Rgb below = weight_colour(-1e-6), above = weight_colour(1 + 1e-6);
    EXPECT_GT(below[2], below[0] + 20);  // blue at once, though light
    EXPECT_GT(above[2], above[1] + 90);  // violet
    EXPECT_EQ(weight_colour(-0.3), (Rgb{8, 48, 107}));
    EXPECT_EQ(weight_colour(1.3), (Rgb{200, 90, 255}));
    // Far out is as at the ends of the ramps.
    EXPECT_EQ(weight_colour(-1e300), weight_colour(-0.3));
    EXPECT_EQ(weight_colour(1e300), weight_colour(1.3));
    // Round-off is neither.
    EXPECT_EQ(weight_colour(-1e-12), weight_colour(0));
    EXPECT_EQ(weight_colour(1 + 1e-12), weight_colour(1));
}

const Rgb ground{7, 7, 7};

cv::Mat picture_of(int width, int height) {
    return {height, width, CV_8UC3, cv::Scalar(ground[0], ground[1], ground[2])};
}

Rgb at(const cv::Mat& picture, int x, int y) {
    const auto& pixel = picture.at<cv::Vec3b>(y, x);
    return {pixel[0], pixel[1], pixel[2]};
}

// Weights that rise by 1 over 400 px from the left edge of a mesh that fills the picture: a tenth each 40 px.
class WeightMap : public testing::Test {
protected:
    WeightMap() : mesh(reference::grid(8, 3, 400, 30, 0.2)), weight(mesh.V.col(0) / 400) {}

    cv::Mat drawn(const Canvas& canvas, int width, int height, double scale) const {
        cv::Mat picture = picture_of(width, height);
        draw_weight(picture, mesh, weight, canvas, scale);
        return picture;
    }

    TriangleMesh mesh;
    Eigen::VectorXd weight;
};

TEST_F(WeightMap, FillsTheMeshWithoutGapsAndNothingElse) {
    const cv::Mat picture = drawn({-10, -5, 420, 40}, 420, 40, 1);
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 420; ++x) {
            const bool inside = x >= 10 && x < 410 && y >= 5 && y < 35;
            EXPECT_EQ(at(picture, x, y) != ground, inside) << x << ", " << y;
        }
    }
}

TEST_F(WeightMap, InterpolatesBetweenVertices) {
    const cv::Mat picture = drawn({0, 0, 400, 30}, 400, 30, 1);
    // Half way between iso-lines.
    for (int x = 19; x < 400; x += 40) EXPECT_EQ(at(picture, x, 15), weight_colour((x + 0.5) / 400)) << x;
}

TEST_F(WeightMap, HasALineAtEachTenthInsideAndAWiderOneInTheMiddle) {
    const cv::Mat picture = drawn({0, 0, 400, 30}, 400, 30, 1);
    const auto is_line = [&](int x) {
        const Rgb expected = weight_colour((x + 0.5) / 400), found = at(picture, x, 15);
        return std::abs(expected[0] - found[0]) > 5 || std::abs(expected[1] - found[1]) > 5;
    };
    for (int line = 1; line <= 9; ++line) {
        const int x = 40 * line;  // between the pixels x - 1 and x
        int left = x, right = x;
        while (is_line(left - 1)) --left;
        while (is_line(right)) ++right;
        EXPECT_EQ(x - left, right - x) << line;
        EXPECT_EQ(right - left, line == 5 ? 4 : 2) << line;
    }
    int lines = 0;
    for (int x = 1; x < 400; ++x) lines += is_line(x) && !is_line(x - 1) ? 1 : 0;
    EXPECT_EQ(lines, 9);  // none at 0 and at 1
    EXPECT_FALSE(is_line(0));
    EXPECT_FALSE(is_line(399));
}

TEST_F(WeightMap, KeepsTheWidthOfItsLinesWhateverTheScale) {
    const auto dark = [](const cv::Mat& picture, int row) {
        // All colours but the line's are light in red up to 3/4.
        int count = 0;
        for (int x = 0; x < picture.cols; ++x) count += at(picture, x, row)[0] < 200 ? 1 : 0;
        return count;
    };
    weight = mesh.V.col(0) / 800;  // up to 1/2
    const int at_one = dark(drawn({0, 0, 400, 30}, 400, 30, 1), 15);
    EXPECT_GT(at_one, 0);
    EXPECT_EQ(dark(drawn({0, 0, 400, 30}, 1600, 120, 4), 60), at_one);
}

TEST_F(WeightMap, HasNoLinesOnPlateaus) {
    weight.setConstant(0.5);
    const cv::Mat picture = drawn({0, 0, 400, 30}, 400, 30, 1);
    for (int y = 0; y < 30; ++y) {
        for (int x = 0; x < 400; ++x) ASSERT_EQ(at(picture, x, y), weight_colour(0.5)) << x << ", " << y;
    }
}

TEST_F(WeightMap, HasNoLinesOutsideOfNoneToAll) {
    weight = mesh.V.col(0).array() / 400 - 1.001;  // below 0 all over
    cv::Mat picture = drawn({0, 0, 400, 30}, 400, 30, 1);
    for (int x = 0; x < 400; ++x) ASSERT_EQ(at(picture, x, 15), weight_colour((x + 0.5) / 400 - 1.001)) << x;
    weight = mesh.V.col(0).array() / 400 + 1.001;
    picture = drawn({0, 0, 400, 30}, 400, 30, 1);
    for (int x = 0; x < 400; ++x) ASSERT_EQ(at(picture, x, 15), weight_colour((x + 0.5) / 400 + 1.001)) << x;
}

TEST(WeightLegend, ShowsTheColoursWithTheirLinesFromEndToEnd) {
    const int width = 520;
    cv::Mat picture = picture_of(width + 20, weight_legend_height() + 10);
    draw_weight_legend(picture, 10, 5, 2000);
    const auto weight_at = [&](int x) { return -0.3 + 1.6 * (x - 10 + 0.5) / width; };
    const int row = 5 + 16;  // within the ramp
    int coloured = 0;
    for (int x = 11; x < width + 9; ++x) coloured += at(picture, x, row) == weight_colour(weight_at(x)) ? 1 : 0;
    EXPECT_GT(coloured, width * 9 / 10);  // but for nine lines
    EXPECT_LT(coloured, width - 2 - 8);
    EXPECT_EQ(at(picture, 9, row), ground);
    EXPECT_EQ(at(picture, width + 10, row), ground);
    // Nothing above or below what it says it takes.
    for (int x = 0; x < picture.cols; ++x) {
        EXPECT_EQ(at(picture, x, 4), ground);
        EXPECT_EQ(at(picture, x, 5 + weight_legend_height()), ground);
    }
}

TEST(WeightLegend, StaysWithinNarrowSheets) {
    cv::Mat picture = picture_of(160, weight_legend_height());
    draw_weight_legend(picture, 20, 0, 120);
    for (int y = 0; y < picture.rows; ++y) {
        for (int x = 0; x < picture.cols; ++x) {
            if (x >= 20 && x < 140) continue;
            EXPECT_EQ(at(picture, x, y), ground) << x << ", " << y;
        }
    }
}

}  // namespace
}  // namespace puppetwarp
