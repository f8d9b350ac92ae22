#include "reference/test_meshes.h"

#include <puppetwarp/mesh/geodesic_distance.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace puppetwarp {
namespace {

TEST(GeodesicDistance, OfAStraightFrontIsExact) {
    const TriangleMesh mesh = reference::grid(20, 10, 100, 40);
    std::vector<int> left;
    for (int v = 0; v < mesh.V.rows(); ++v) {
        if (mesh.V(v, 0) <= 0) left.push_back(v);
    }
    EXPECT_LT((geodesic_distance(mesh, left) - mesh.V.col(0)).cwiseAbs().maxCoeff(), 1e-12);
}

// A disc as source, whose fronts are round.
TEST(GeodesicDistance, OfARoundFrontConverges) {
    const auto error_at = [](double edge) {
        const TriangleMesh mesh = reference::shape([](double, double) { return true; }, 100, edge);
        std::vector<int> sources;
        for (int v = 0; v < mesh.V.rows(); ++v) {
            if ((mesh.V.row(v) - Eigen::RowVector2d(30, 40)).norm() <= 15) sources.push_back(v);
        }
        const Eigen::VectorXd distance = geodesic_distance(mesh, sources);
        double error = 0;
        for (int v = 0; v < mesh.V.rows(); ++v) {
            const double exact = std::max(0.0, (mesh.V.row(v) - Eigen::RowVector2d(30, 40)).norm() - 15);
            error = std::max(error, std::abs(distance(v) - exact));
        }
        return error;
    };
    const double fine = error_at(1);
    EXPECT_LT(fine, 1);
    EXPECT_LT(fine, error_at(4) / 3);
}

TEST(GeodesicDistance, GoesRoundCornersAndNotAcrossGaps) {
    const auto horseshoe = [](double x, double y) { return (std::abs(y - 50) > 10 || x > 80); };
    const TriangleMesh mesh = reference::shape(horseshoe, 100, 1);
    const int from = reference::nearest_vertex(mesh, {5, 30}), to = reference::nearest_vertex(mesh, {5, 70});
    const Point a = mesh.V.row(from).transpose(), b = mesh.V.row(to).transpose();
    const Point above(80, 40), below(80, 60);
    const double exact = (above - a).norm() + 20 + (b - below).norm();
    // First order: each edge on the way costs some.
    EXPECT_NEAR(geodesic_distance(mesh, {from})(to), exact, 0.02 * exact);
    EXPECT_EQ(geodesic_distance(mesh, {from})(from), 0);
}

TEST(GeodesicDistance, IsInfiniteOnOtherComponentsAndWithoutSources) {
    const TriangleMesh mesh = reference::joined(reference::grid(3, 3, 9, 9), reference::grid(3, 3, 9, 9), {20, 0});
    const Eigen::VectorXd distance = geodesic_distance(mesh, {0});
    EXPECT_TRUE(distance.head(16).allFinite());
    EXPECT_TRUE((distance.tail(16).array() == std::numeric_limits<double>::infinity()).all());
    EXPECT_FALSE(geodesic_distance(mesh, {}).array().isFinite().any());
}

}  // namespace
}  // namespace puppetwarp
