#include "cages.h"
#include "reference/test_meshes.h"

#include <puppetwarp/weights/shepard.h>

#include <gtest/gtest.h>

namespace puppetwarp {

using namespace tests;

namespace {

// The formula of the paper as it stands.
TEST(Shepard, IsTheInverseSquaredDistanceOverTheirSum) {
    const TriangleMesh mesh = reference::grid(12, 9, 120, 90, 0.2, 2);
    const Rig rig{{{"p", PointHandle{{20.5, 31}, {}}},
                   {"b", BoneHandle{{60, 10}, {90, 10}, ""}},
                   {"r", RegionHandle{{{70, 50}, {100, 50}, {100, 80}, {70, 80}}, Falloff::none}}},
                  {}};
    const Eigen::MatrixXd W = shepard_weights(mesh, rig);
    for (Eigen::Index v = 0; v < W.rows(); ++v) {
        const Point p = mesh.V.row(v).transpose();
        const auto outside = [](double x, double low, double high) { return std::max({low - x, x - high, 0.0}); };
        const double to_point = (p - Point(20.5, 31)).norm();
        const double to_bone = std::hypot(outside(p.x(), 60, 90), p.y() - 10);
        const double to_region = std::hypot(outside(p.x(), 70, 100), outside(p.y(), 50, 80));
        if (to_region == 0 || to_bone < 1e-9) continue;
        Eigen::RowVector3d expected(std::pow(to_point, -2), std::pow(to_bone, -2), std::pow(to_region, -2));
        expected /= expected.sum();
        EXPECT_LT((W.row(v) - expected).cwiseAbs().maxCoeff(), 1e-12);
        EXPECT_GT(W.row(v).minCoeff(), 0) << "every handle acts everywhere";
    }
}

TEST(Shepard, HandlesAtNoDistanceShareAlike) {
    const TriangleMesh mesh = reference::grid(4, 4, 40, 40);
    const Rig rig{{{"a", PointHandle{{20, 20}, {}}}, {"b", VertexHandle{12}}, {"c", PointHandle{{0, 0}, {}}}}, {}};
    EXPECT_EQ(shepard_weights(mesh, rig).row(12), Eigen::RowVector3d(0.5, 0.5, 0));
}

TEST(Shepard, IsLinearOnTheEdgesOfACage) {
    const TriangleMesh mesh = reference::grid(10, 10, 100, 100);
    const Rig rig{{cage_handle("hull", {{0, 0}, {100, 0}, {100, 100}, {0, 100}})}, {}};
    const Eigen::MatrixXd W = shepard_weights(mesh, rig);
    for (Eigen::Index i = 0; i <= 10; ++i) {
        const double along = static_cast<double>(i) / 10;
        EXPECT_LT((W.row(i) - Eigen::RowVector4d(1 - along, along, 0, 0)).cwiseAbs().maxCoeff(), 1e-12) << i;
    }
}

TEST(Shepard, DoesNotOverflowHoweverLargeOrSmallTheSubjectIs) {
    const TriangleMesh mesh = reference::grid(3, 3, 30, 30);
    const Rig rig = reference::rig_of_points({{0, 0}, {30, 20}, {10, 30}});
    const Eigen::MatrixXd expected = shepard_weights(mesh, rig);
    for (const double size : {1e-120, 1e120}) {
        TriangleMesh scaled = mesh;
        scaled.V *= size;
        const Rig points = reference::rig_of_points({{0, 0}, {30 * size, 20 * size}, {10 * size, 30 * size}});
        EXPECT_LT((shepard_weights(scaled, points) - expected).cwiseAbs().maxCoeff(), 1e-12) << size;
    }
}

}  // namespace
}  // namespace puppetwarp
