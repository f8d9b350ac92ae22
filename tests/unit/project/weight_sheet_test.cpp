#include <puppetwarp/project/weight_sheet.h>

#include "reference/test_meshes.h"
#include "support/message_of.h"

#include <puppetwarp/base/errors.h>

#include <opencv2/imgproc.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace puppetwarp {
namespace {

using testing::HasSubstr;

// A plate of 400 x 200 with points left, middle and right.
class WeightSheet : public testing::Test {
protected:
    WeightSheet() : mesh(reference::grid(40, 20, 400, 200)) {
        rig.handles = {{"left", PointHandle{{100, 100}, {}}},
                       {"middle", PointHandle{{200, 100}, {}}},
                       {"right", PointHandle{{300, 100}, {}}}};
        options.columns = 1;
        options.cell_px = 200;
    }

    Weights weights() {
        Progress progress;
        return compute_weights(mesh, rig, {.kind = kind}, progress);
    }
    Image sheet() { return sheet_of(weights()); }
    Image sheet_of(const Weights& given) {
        Progress progress;
        return draw_weight_sheet(mesh, rig, given, "a title", options, progress);
    }
    // The middles of what marks the handle of each map, the only yellow on a sheet without weights but for the legend;
    // from above, then from the left.
    std::vector<cv::Point2d> own_marks() {
        Weights none = weights();
        none.W.setZero();
        const Image drawn = sheet_of(none);
        cv::Mat mask, labels, stats, centroids;
        cv::inRange(above_legend(drawn), cv::Scalar(110, 80, 0), cv::Scalar(255, 205, 90), mask);
        const int count = cv::connectedComponentsWithStats(mask, labels, stats, centroids, 8);
        std::vector<cv::Point2d> marks;
        for (int k = 1; k < count; ++k) marks.emplace_back(centroids.at<double>(k, 0), centroids.at<double>(k, 1));
        return marks;
    }
    static cv::Mat above_legend(const Image& drawn) { return drawn.pixels.rowRange(0, drawn.pixels.rows - 70); }
    std::string refusal() {
        return message_of([&] { sheet(); });
    }

    TriangleMesh mesh;
    Rig rig;
    WeightKind kind = WeightKind::harmonic;
    WeightSheetOptions options;
};

bool same_pictures(const Image& a, const Image& b) {
    return a.pixels.size() == b.pixels.size() && a.pixels.type() == b.pixels.type() &&
           cv::norm(a.pixels, b.pixels, cv::NORM_INF) == 0;
}

TEST_F(WeightSheet, IsTheSameEachTime) {
    const Image first = sheet();
    EXPECT_EQ(first.pixels.type(), CV_8UC3);
    EXPECT_TRUE(same_pictures(first, sheet()));
}

TEST_F(WeightSheet, HasOneCellAColumnOfWeights) {
    const cv::Size three = sheet().pixels.size();
    options.columns = 2;
    const cv::Size two_wide = sheet().pixels.size();
    options.columns = 3;
    const cv::Size in_a_row = sheet().pixels.size();
    EXPECT_EQ(two_wide.width - three.width, in_a_row.width - two_wide.width);
    EXPECT_EQ(three.height - two_wide.height, two_wide.height - in_a_row.height);
    EXPECT_GT(three.height - two_wide.height, 100);  // a map is 200 x 100 and has a name
    options.columns = 64;                            // more than there are
    EXPECT_EQ(sheet().pixels.size(), in_a_row);
}

TEST_F(WeightSheet, GrowsWithItsCells) {
    const cv::Size small = sheet().pixels.size();
    options.cell_px = 600;
    const cv::Size large = sheet().pixels.size();
    EXPECT_GE(large.width, 600);
    EXPECT_NEAR(large.height - small.height, 3 * 0.5 * 400, 60);  // three maps half as high as wide, but for margins
}

TEST_F(WeightSheet, MarksInEachMapWhoseItIs) {
    const std::vector<cv::Point2d> marks = own_marks();
    ASSERT_EQ(marks.size(), 3u);
    EXPECT_NEAR(marks[2].y - marks[1].y, marks[1].y - marks[0].y, 0.5);
    EXPECT_NEAR(marks[2].x - marks[1].x, marks[1].x - marks[0].x, 0.5);
    // A quarter of the plate, which fills a map of 200 px but for a margin.
    EXPECT_GT(marks[1].x - marks[0].x, 40);
    EXPECT_LT(marks[1].x - marks[0].x, 50);
}

TEST_F(WeightSheet, MarksTheCornerWhoseMapItIs) {
    kind = WeightKind::mean_value;
    rig.handles = {{"hull", CageHandle{{{-40, -40}, {440, -40}, {440, 240}, {-40, 240}}}}};
    options.columns = 4;
    const std::vector<cv::Point2d> marks = own_marks();  // two above, two below
    ASSERT_EQ(marks.size(), 4u);
    const double cell = marks[1].x - marks[0].x, width = 216 + 24;  // of a column and the gap after it
    EXPECT_GT(cell, width);                                         // from an upper left to an upper right corner
    EXPECT_NEAR(marks[0].y, marks[1].y, 0.5);
    EXPECT_NEAR(marks[2].y, marks[3].y, 0.5);
    // Clockwise: corner 2, below right, is in the third map, corner 3, below left, in the fourth.
    EXPECT_NEAR(marks[2].x - marks[1].x, width, 0.5);
    EXPECT_NEAR(marks[3].x - marks[0].x, 3 * width, 0.5);
    EXPECT_GT(marks[2].y - marks[0].y, 80);
}

TEST_F(WeightSheet, MarksVerticesBonesAndRegions) {
    rig.handles = {{"vertex", VertexHandle{10 * 41 + 10}},
                   {"upper", BoneHandle{{200, 60}, {200, 100}, ""}},
                   {"lower", BoneHandle{{200, 100}, {200, 140}, "upper"}},
                   {"spot", RegionHandle{{{300, 80}, {340, 80}, {340, 120}, {300, 120}}}}};
    const std::vector<cv::Point2d> marks = own_marks();
    ASSERT_EQ(marks.size(), 4u);
    EXPECT_NEAR((marks[3].x - marks[1].x) / (marks[1].x - marks[0].x), 1.2, 0.05);  // x = 100, 200, 320
    EXPECT_NEAR(marks[1].x, marks[2].x, 0.5);
}

TEST_F(WeightSheet, ColoursEachMapByItsOwnColumn) {
    Weights given = weights();
    given.W.setZero();
    given.W.col(1).setOnes();
    // Dark red all over the second map, only there.
    const Image drawn = sheet_of(given);
    cv::Mat mask;
    cv::inRange(above_legend(drawn), cv::Scalar(128, 0, 38), cv::Scalar(128, 0, 38), mask);
    const cv::Rect field = cv::boundingRect(mask);
    EXPECT_GT(field.width, 160);
    EXPECT_LT(field.height, 101);
    const std::vector<cv::Point2d> marks = own_marks();
    ASSERT_EQ(marks.size(), 3u);
    EXPECT_NEAR(field.y + field.height / 2.0, marks[1].y, 2);
}

TEST_F(WeightSheet, DoesNotDependOnTheUnitOfTheMesh) {
    const Image in_pixels = sheet();
    const double unit = 1.0 / 1024;
    mesh.V *= unit;
    for (Handle& handle : rig.handles) std::get<PointHandle>(handle.shape).at *= unit;
    EXPECT_TRUE(same_pictures(in_pixels, sheet()));
}

TEST_F(WeightSheet, OfComplexWeightsIsThatOfTheirRealPart) {
    kind = WeightKind::green;
    rig.handles = {{"hull", CageHandle{{{-40, -40}, {440, -40}, {440, 240}, {-40, 240}}}}};
    Weights given = weights();
    ASSERT_GT(given.W_imaginary.cwiseAbs().maxCoeff(), 0.01);
    const Image both = sheet_of(given);
    given.W_imaginary *= 0.5;
    EXPECT_TRUE(same_pictures(both, sheet_of(given)));
}

TEST_F(WeightSheet, RefusesWhatMakesNoSheet) {
    EXPECT_EQ(refusal(), "");
    options.cell_px = 119;
    EXPECT_THAT(refusal(), HasSubstr("cell size 119"));
    options.cell_px = 2001;
    EXPECT_THAT(refusal(), HasSubstr("120 to 2000"));
    options.cell_px = 200;
    for (const int columns : {-1, 65}) {
        options.columns = columns;
        EXPECT_THAT(refusal(), HasSubstr("columns " + std::to_string(columns)));
    }
    options.columns = 1;
    options.max_pixels = 10'000;
    EXPECT_THAT(refusal(), HasSubstr("more than 10000"));
}

TEST_F(WeightSheet, CanBeCancelled) {
    class Stopped : public Progress {
        bool cancelled() const override { return true; }
    } progress;
    const Weights given = weights();
    EXPECT_THROW(draw_weight_sheet(mesh, rig, given, "a title", options, progress), Cancelled);
}

}  // namespace
}  // namespace puppetwarp
