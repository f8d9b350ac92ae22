#include <puppetwarp/project/overlay.h>

#include <opencv2/core.hpp>

#include <gtest/gtest.h>

#include <numbers>

namespace puppetwarp {
namespace {

Image grey_picture(int type) {
    Image image;
    image.pixels = cv::Mat(60, 80, type,
                           cv::Scalar::all(0.5 * (CV_MAT_DEPTH(type) == CV_8U    ? 255
                                                  : CV_MAT_DEPTH(type) == CV_16U ? 65535
                                                                                 : 1)));
    return image;
}

TEST(Overlay, DrawsEdgesWhereTheyAreAndNothingElse) {
    Eigen::MatrixX2d V(3, 2);
    V << 10.5, 10.5, 60.5, 10.5, 10.5, 40.5;
    Eigen::MatrixX3i F(1, 3);
    F << 0, 1, 2;
    for (const int type : {CV_8UC1, CV_8UC4, CV_16UC3, CV_32FC2}) {
        const Image before = grey_picture(type);
        Image after = grey_picture(type);
        draw_mesh(after, V, F, {0, 0, 80, 60});
        cv::Mat difference, any;
        cv::absdiff(before.pixels, after.pixels, difference);
        cv::transform(difference, any, cv::Mat::ones(1, difference.channels(), CV_32F));
        any.convertTo(any, CV_64F);
        EXPECT_GT(any.at<double>(10, 30), 0) << type;  // on the upper edge
        EXPECT_GT(any.at<double>(20, 10), 0) << type;  // on the left edge
        EXPECT_EQ(any.at<double>(16, 20), 0) << type;  // inside
        EXPECT_EQ(any.at<double>(50, 70), 0) << type;  // outside
    }
}

TEST(Overlay, CanvasMovesTheDrawing) {
    Rig rig;
    rig.handles = {{"a", PointHandle{{30, 20}, {}}}};
    Image picture = grey_picture(CV_8UC3);
    draw_handles(picture, rig, {}, {-20, -10, 80, 60});
    EXPECT_NE(picture.pixels.at<cv::Vec3b>(30, 50), cv::Vec3b(128, 128, 128));
    EXPECT_EQ(picture.pixels.at<cv::Vec3b>(20, 30), cv::Vec3b(128, 128, 128));
}

TEST(Overlay, ScaleMovesTheDrawingButKeepsItsMarks) {
    Rig rig;
    rig.handles = {{"a", PointHandle{{30, 20}, {}}}};
    Image large = grey_picture(CV_8UC1), same = grey_picture(CV_8UC1);
    draw_handles(large, rig, {}, {10, 5, 40, 30}, 2);  // (30, 20) is at (40, 30) of the picture
    rig.handles = {{"a", PointHandle{{40, 30}, {}}}};
    draw_handles(same, rig, {}, {0, 0, 80, 60});
    EXPECT_EQ(cv::norm(large.pixels, same.pixels, cv::NORM_INF), 0);
}

TEST(Overlay, StyleSaysColoursAndSize) {
    Rig rig;
    rig.handles = {{"a", PointHandle{{30.5, 20.5}, {}}}};
    const auto drawn = [&](const HandleStyle& style) {
        Image picture = grey_picture(CV_8UC3);
        draw_handles(picture, rig, {}, {0, 0, 80, 60}, 1, style);
        return picture.pixels;
    };
    const auto area = [](const cv::Mat& pixels) {
        cv::Mat mask;
        cv::inRange(pixels, cv::Scalar(128, 128, 128), cv::Scalar(128, 128, 128), mask);
        return static_cast<int>(mask.total()) - cv::countNonZero(mask);
    };
    const cv::Mat usual = drawn({{0, 0, 1}, {1, 0, 0}, 1}), half = drawn({{0, 0, 1}, {1, 0, 0}, 0.5});
    EXPECT_EQ(usual.at<cv::Vec3b>(20, 30), cv::Vec3b(0, 0, 255));  // the middle of the disc
    EXPECT_EQ(half.at<cv::Vec3b>(20, 30), cv::Vec3b(0, 0, 255));
    EXPECT_GT(usual.at<cv::Vec3b>(20, 36)[0], 150);  // its rim, from 5 to 7 px
    EXPECT_EQ(half.at<cv::Vec3b>(20, 36), cv::Vec3b(128, 128, 128));
    EXPECT_LT(area(half), area(usual) / 2);
    EXPECT_EQ(area(usual), area(drawn({})));
}

TEST(Overlay, BonesFollowTheirParentsAndRegionsTheirCentroids) {
    Rig rig;
    rig.handles = {{"upper", BoneHandle{{20.5, 30.5}, {40.5, 30.5}, ""}},
                   {"lower", BoneHandle{{40.5, 30.5}, {55.5, 30.5}, "upper"}},
                   {"spot", RegionHandle{{{50, 5}, {54, 5}, {54, 9}, {50, 9}}}}};
    Pose pose;
    pose.handles["upper"].rotate_rad = -std::numbers::pi / 2;  // up on the screen
    pose.handles["spot"].to = Point(70.5, 50.5);
    Image picture = grey_picture(CV_8UC1);
    draw_handles(picture, rig, pose, {0, 0, 80, 60});
    const auto drawn = [&](int x, int y) { return picture.pixels.at<std::uint8_t>(y, x) != 128; };
    EXPECT_TRUE(drawn(20, 20));   // along the upper bone
    EXPECT_TRUE(drawn(20, 1));    // along the lower one, which starts at (20.5, 10.5)
    EXPECT_FALSE(drawn(48, 30));  // where it was
    EXPECT_TRUE(drawn(70, 48));   // the region's upper edge
    EXPECT_FALSE(drawn(52, 20));
}

TEST(Overlay, FarPositionsAreClippedNotWrapped) {
    Eigen::MatrixX2d V(3, 2);
    V << 10, 30.5, 1e15, 30.5, 10, 1e300;
    Eigen::MatrixX3i F(1, 3);
    F << 0, 1, 2;
    Image picture = grey_picture(CV_8UC1);
    draw_mesh(picture, V, F, {0, 0, 80, 60});
    EXPECT_NE(picture.pixels.at<std::uint8_t>(30, 70), 128);
    EXPECT_EQ(picture.pixels.at<std::uint8_t>(10, 70), 128);
}

}  // namespace
}  // namespace puppetwarp
