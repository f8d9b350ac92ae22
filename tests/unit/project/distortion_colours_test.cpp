#include <puppetwarp/project/distortion_colours.h>

#include <puppetwarp/mesh/distortion.h>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace puppetwarp {
namespace {

// A right triangle with legs of 8 px along the axes.
TriangleMesh one_triangle() {
    TriangleMesh mesh;
    mesh.V.resize(3, 2);
    mesh.V << 2, 2, 10, 2, 2, 10;
    mesh.F.resize(1, 3);
    mesh.F << 0, 1, 2;
    return mesh;
}

// V mapped by a matrix.
Eigen::MatrixX2d mapped(const TriangleMesh& mesh, const Eigen::Matrix2d& J) {
    return mesh.V * J.transpose();
}

TEST(PrincipalStretches, AreSingularValuesSignedByTheArea) {
    const TriangleMesh mesh = one_triangle();
    const auto stretches = [&](const Eigen::Matrix2d& J) -> Eigen::RowVector2d {
        return principal_stretches(mesh, mapped(mesh, J)).row(0);
    };
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(0.7).toRotationMatrix();
    EXPECT_TRUE(stretches(turn).isApprox(Eigen::RowVector2d(1, 1), 1e-14));
    EXPECT_TRUE(stretches(turn * Eigen::Vector2d(0.5, 3).asDiagonal()).isApprox(Eigen::RowVector2d(3, 0.5), 1e-14));
    EXPECT_TRUE(stretches(turn * Eigen::Vector2d(-2, 3).asDiagonal()).isApprox(Eigen::RowVector2d(3, -2), 1e-14));
    const double golden = (1 + std::sqrt(5.0)) / 2;  // of the shear by 1
    EXPECT_TRUE(stretches((Eigen::Matrix2d() << 1, 1, 0, 1).finished())
                    .isApprox(Eigen::RowVector2d(golden, 1 / golden), 1e-14));
    EXPECT_EQ(stretches(Eigen::Matrix2d::Zero()), Eigen::RowVector2d(0, 0));
    EXPECT_NEAR(stretches((Eigen::Matrix2d() << 1, 0, 0, 0).finished())(1), 0, 1e-15);
}

// By hand from the ramps: colours at 0, 1/5, ... 1 of the way in log(distortion) from 1 to the darkest.
TEST(DistortionColours, AreThoseOfTheRamps) {
    const double d = darkest_distortion;
    const double half = std::sqrt(d);       // half way: between the third and the fourth colour
    const double fifth = std::pow(d, 0.2);  // the second colour
    EXPECT_EQ(distortion_colour(1, 1), (Rgb{255, 255, 255}));
    EXPECT_EQ(distortion_colour(d, 1), (Rgb{103, 0, 31}));
    EXPECT_EQ(distortion_colour(1, 1 / d), (Rgb{5, 48, 97}));
    EXPECT_EQ(distortion_colour(d, 1 / d), (Rgb{26, 26, 26}));
    EXPECT_EQ(distortion_colour(fifth, fifth), (Rgb{253, 219, 199}));
    EXPECT_EQ(distortion_colour(1 / fifth, 1 / fifth), (Rgb{209, 229, 240}));
    // (244 + 214) / 2, (165 + 96) / 2, (130 + 77) / 2; halves may fall either way.
    const Rgb red = distortion_colour(half, half);
    EXPECT_EQ(red[0], 229);
    EXPECT_NEAR(red[1], 130.5, 0.5);
    EXPECT_NEAR(red[2], 103.5, 0.5);
}

TEST(DistortionColours, MixByHowMuchOfItIsGrowth) {
    // Grows by `most` one way and shrinks by its cube root the other: hue (1 - 1/3) / (1 + 1/3) = 1/2, half red, half
    // grey, at the darkest.
    const double d = darkest_distortion;
    const Rgb mixed = distortion_colour(d, std::pow(d, -1.0 / 3));
    EXPECT_NEAR(mixed[0], (103 + 26) / 2.0, 0.51);
    EXPECT_NEAR(mixed[1], (0 + 26) / 2.0, 0.51);
    EXPECT_NEAR(mixed[2], (31 + 26) / 2.0, 0.51);
}

TEST(DistortionColours, DependOnTheSymmetricMeasureAloneForSimilarities) {
    EXPECT_EQ(distortion_colour(100, 50), distortion_colour(darkest_distortion, darkest_distortion));
    EXPECT_EQ(distortion_colour(0.02, 0.01), distortion_colour(1, 1 / darkest_distortion));
    EXPECT_EQ(distortion_colour(1.3, 1.1), distortion_colour(1.3, 1.3));  // nothing shrinks
}

TEST(DistortionColours, FoldsAndCollapsesAreMagenta) {
    const Rgb magenta{255, 0, 255};
    EXPECT_EQ(distortion_colour(1, -1), magenta);
    EXPECT_EQ(distortion_colour(1, 0), magenta);
    EXPECT_EQ(distortion_colour(0, 0), magenta);
    EXPECT_EQ(distortion_colour(1, std::nan("")), magenta);
}

TEST(DistortionColours, FillTrianglesWhereTheyAre) {
    const TriangleMesh mesh = one_triangle();
    cv::Mat picture(80, 80, CV_8UC3, cv::Scalar(1, 2, 3));
    const Eigen::MatrixX2d moved = mapped(mesh, Eigen::Matrix2d::Identity() * darkest_distortion);  // (4, 4) to (20, 4)
    draw_distortion(picture, mesh, moved, {-5, -10, 20, 20}, 2);
    EXPECT_EQ(picture.at<cv::Vec3b>(34, 24), cv::Vec3b(103, 0, 31));  // (7.25, 7.25) in image space
    EXPECT_EQ(picture.at<cv::Vec3b>(34, 10), cv::Vec3b(1, 2, 3));     // to the left of it
    EXPECT_EQ(picture.at<cv::Vec3b>(60, 48), cv::Vec3b(1, 2, 3));     // below the long side
}

TEST(DistortionColours, FoldedTrianglesLieOnTop) {
    TriangleMesh mesh;
    mesh.V.resize(6, 2);
    mesh.V << 0, 0, 30, 0, 0, 30, 100, 0, 130, 0, 100, 30;
    mesh.F.resize(2, 3);
    mesh.F << 0, 1, 2, 3, 4, 5;
    Eigen::MatrixX2d moved = mesh.V;
    moved.row(0) << 0, 30;  // the first is folded over ...
    moved.row(2) << 0, 0;
    moved.bottomRows(3) = mesh.V.topRows(3);  // ... and the second, drawn later, moved onto it
    cv::Mat picture(40, 40, CV_8UC3, cv::Scalar::all(0));
    draw_distortion(picture, mesh, moved, {0, 0, 40, 40}, 1);
    EXPECT_EQ(picture.at<cv::Vec3b>(8, 8), cv::Vec3b(255, 0, 255));
}

TEST(DistortionColours, LegendKeepsToItsPlace) {
    for (const int width : {216, 700}) {
        const cv::Rect place(20, 30, width, distortion_legend_height());
        cv::Mat sheet(place.height + 60, width + 40, CV_8UC3, cv::Scalar::all(255));
        draw_distortion_legend(sheet, place.x, place.y, width);
        const cv::Rect drawn(place.x, place.y, place.width, place.height);
        EXPECT_GT(cv::norm(sheet(drawn), cv::Mat(drawn.size(), CV_8UC3, cv::Scalar::all(255)), cv::NORM_INF), 200);
        sheet(drawn).setTo(cv::Scalar::all(255));
        EXPECT_EQ(cv::norm(sheet, cv::Mat(sheet.size(), CV_8UC3, cv::Scalar::all(255)), cv::NORM_INF), 0) << width;
    }
}

}  // namespace
}  // namespace puppetwarp
