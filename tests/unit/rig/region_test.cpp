#include "reference/test_meshes.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/rig/binding.h>
#include <puppetwarp/rig/region.h>

#include <gmock/gmock.h>

#include <cmath>

namespace puppetwarp {
namespace {

TEST(RegionCentroid, IsTheCentreOfTheArea) {
    // An L of two rectangles: (0,0)-(4,2) with area 8 and centre (2, 1), (0,2)-(2,6) with area 8 and centre (1, 4).
    const Polyline l{{0, 0}, {4, 0}, {4, 2}, {2, 2}, {2, 6}, {0, 6}};
    EXPECT_LT((region_centroid(l) - Point(1.5, 2.5)).norm(), 1e-14);
    Polyline reversed(l.rbegin(), l.rend());
    for (Point& p : reversed) p += Point(1e6, -1e6);
    EXPECT_LT((region_centroid(reversed) - Point(1e6 + 1.5, -1e6 + 2.5)).norm(), 1e-8);
}

TEST(RegionCentroid, OfNoAreaIsTheMeanOfTheCorners) {
    EXPECT_EQ(region_centroid({{0, 0}, {3, 3}, {6, 6}}), Point(3, 3));
    EXPECT_EQ(region_centroid({{0, 0}, {4, 4}, {4, 0}, {0, 4}}), Point(2, 2));  // a bow tie
}

StiffnessPicture ramp(int columns, int rows) {
    StiffnessPicture picture;
    picture.max = 21;
    picture.width_px = 40;
    picture.height_px = 30;
    picture.grey.create(rows, columns, CV_32FC1);
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            picture.grey.at<float>(j, i) = static_cast<float>(0.75 * (i + 0.5) / columns + 0.25 * (j + 0.5) / rows);
        }
    }
    return picture;
}

TEST(Stiffness, OfAPictureIsItsGreyStretchedOverTheImage) {
    const TriangleMesh mesh = reference::grid(16, 12, 40, 30);
    for (const auto& [columns, rows] : {std::pair(40, 30), std::pair(20, 60)}) {
        const Eigen::VectorXd s = triangle_stiffness(mesh, {ramp(columns, rows)});
        for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
            const Point c = (mesh.V.row(mesh.F(t, 0)) + mesh.V.row(mesh.F(t, 1)) + mesh.V.row(mesh.F(t, 2))) / 3;
            // Half a pixel from the border on, a linear ramp is itself between its pixels.
            if (c.x() < 1 || c.x() > 39 || c.y() < 0.5 || c.y() > 29.5) continue;
            EXPECT_NEAR(s(t), 1 + 20 * (0.75 * c.x() / 40 + 0.25 * c.y() / 30), 1e-5);
        }
        EXPECT_GE(s.minCoeff(), 1);
        EXPECT_LE(s.maxCoeff(), 21);
    }
}

TEST(Stiffness, OfPicturesAndRegionsMultiplies) {
    const TriangleMesh mesh = reference::grid(4, 3, 40, 30);
    const Eigen::VectorXd alone = triangle_stiffness(mesh, {ramp(40, 30)});
    const StiffnessRegion all{{{-1, -1}, {50, -1}, {50, 50}, {-1, 50}}, 3};
    EXPECT_LT((triangle_stiffness(mesh, {all, ramp(40, 30)}) - 3 * alone).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Stiffness, APictureMustBeLoaded) {
    const TriangleMesh mesh = reference::grid(4, 3, 40, 30);
    StiffnessPicture picture;
    picture.path = "stiff.png";
    EXPECT_THROW(triangle_stiffness(mesh, {picture}), InvalidInput);
}

}  // namespace
}  // namespace puppetwarp
