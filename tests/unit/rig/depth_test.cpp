#include "reference/test_meshes.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/rig/depth.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace puppetwarp {
namespace {

using reference::grid;

Pose with_depths(const std::map<std::string, double>& depths) {
    Pose pose;
    for (const auto& [id, depth] : depths) pose.handles[id].depth = depth;
    return pose;
}

// The cotangent of the angle at p.
double cotangent(const Point& p, const Point& a, const Point& b) {
    const Point u = a - p, v = b - p;
    return u.dot(v) / std::abs(u.x() * v.y() - u.y() * v.x());
}

// How far each vertex is from the cotangent-weighted mean of its neighbours.
Eigen::VectorXd imbalance(const TriangleMesh& mesh, const Eigen::VectorXd& depth) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(depth.size()), weights = sum;
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const int i = mesh.F(f, k), j = mesh.F(f, (k + 1) % 3), l = mesh.F(f, (k + 2) % 3);
            const double weight = cotangent(mesh.V.row(l), mesh.V.row(i), mesh.V.row(j));
            sum(i) += weight * (depth(j) - depth(i));
            sum(j) += weight * (depth(i) - depth(j));
            weights(i) += weight;
            weights(j) += weight;
        }
    }
    return sum.cwiseQuotient(weights);
}

TEST(VertexDepths, AreNoneWithoutADepthInThePose) {
    const TriangleMesh mesh = grid(4, 3, 40, 30);
    const Rig rig = reference::rig_of_points({{5, 5}, {35, 25}});
    EXPECT_EQ(vertex_depths(mesh, rig, Pose()).size(), 0);
    Pose pose;
    pose.handles["p0"].to = Point(8, 8);
    EXPECT_EQ(vertex_depths(mesh, rig, pose).size(), 0);
}

TEST(VertexDepths, OneDepthIsTheSameEverywhereToTheBit) {
    const TriangleMesh mesh = grid(8, 6, 40, 30, 0.2);
    const Rig one = reference::rig_of_points({{5, 5}});
    EXPECT_TRUE((vertex_depths(mesh, one, with_depths({{"p0", 0.1}})).array() == 0.1).all());
    const Rig two = reference::rig_of_points({{5, 5}, {35, 25}});
    EXPECT_TRUE((vertex_depths(mesh, two, with_depths({{"p0", -3}, {"p1", -3}})).array() == -3).all());
}

TEST(VertexDepths, AreHarmonicBetweenHandles) {
    for (const TriangleMesh& mesh : {grid(30, 20, 60, 40, 0.2), reference::figure(200, 6)}) {
        const double size = mesh.V.maxCoeff();
        Rig rig = reference::rig_of_vertices({reference::nearest_vertex(mesh, {0.3 * size, 0.4 * size}),
                                              reference::nearest_vertex(mesh, {0.6 * size, 0.5 * size}), 0});
        const Eigen::VectorXd depth = vertex_depths(mesh, rig, with_depths({{"v0", 2}, {"v1", -1}}));
        Eigen::VectorXd off = imbalance(mesh, depth).cwiseAbs();
        for (const Handle& handle : rig.handles) off(std::get<VertexHandle>(handle.shape).index) = 0;
        EXPECT_LT(off.maxCoeff(), 1e-12);
        EXPECT_EQ(depth(std::get<VertexHandle>(rig.handles[0].shape).index), 2);
        EXPECT_EQ(depth(std::get<VertexHandle>(rig.handles[1].shape).index), -1);
        EXPECT_EQ(depth(0), 0);  // not named: 0
    }
}

// The disc of a point, not a vertex, is held: a single vertex would hold less and less of a finer mesh.
TEST(VertexDepths, AreTheSameAtEveryDensity) {
    std::vector<double> middle;
    for (const int n : {20, 40, 80}) {
        const TriangleMesh mesh = grid(3 * n, n, 300, 100);
        const Rig rig = reference::rig_of_points({{40, 30}, {220, 60}, {150, 90}});
        const Eigen::VectorXd depth = vertex_depths(mesh, rig, with_depths({{"p0", 1}}));
        middle.push_back(depth(reference::nearest_vertex(mesh, {120, 50})));
    }
    EXPECT_NEAR(middle[0], middle[2], 0.05);
    EXPECT_NEAR(middle[1], middle[2], 0.02);
}

TEST(VertexDepths, OfAnArmComeForwardWithItsHandAlone) {
    using namespace reference::figure_places;
    const TriangleMesh mesh = reference::figure(200, 5);
    const auto at = [&](const Point& share) { return Point(200 * share); };
    const Rig rig = reference::rig_of_points({at(right_hand), at(right_shoulder), at(belly), at(head)});
    const Eigen::VectorXd depth = vertex_depths(mesh, rig, with_depths({{"p0", 1}}));
    const auto near = [&](const Point& p) { return depth(reference::nearest_vertex(mesh, p)); };
    EXPECT_EQ(near(at(right_hand)), 1);
    EXPECT_EQ(near(at(right_shoulder)), 0);
    EXPECT_EQ(near(at(belly)), 0);
    EXPECT_GT(near(at(0.5 * (right_hand + right_shoulder))), 0.2);
    EXPECT_LT(near(at(left_foot)), 0.02);
    EXPECT_GE(depth.minCoeff(), -1e-12);
    EXPECT_LE(depth.maxCoeff(), 1 + 1e-12);
}

TEST(VertexDepths, OfOtherComponentsAreZeroOrTheirOwn) {
    const TriangleMesh one = grid(8, 6, 40, 30);
    const TriangleMesh mesh = reference::joined(reference::joined(one, one, {100, 0}), one, {200, 0});
    const Rig rig = reference::rig_of_points({{20, 15}, {120, 15}});
    const Eigen::VectorXd depth = vertex_depths(mesh, rig, with_depths({{"p1", 4}}));
    const Eigen::Index n = one.V.rows();
    EXPECT_TRUE((depth.segment(0, n).array() == 0).all());
    EXPECT_TRUE((depth.segment(n, n).array() == 4).all());
    EXPECT_TRUE((depth.segment(2 * n, n).array() == 0).all());  // no handle at all
}

TEST(VertexDepths, OfBonesGoToTheirChildren) {
    const TriangleMesh mesh = grid(60, 10, 60, 10);
    Rig rig;
    rig.handles = {{"upper", BoneHandle{{20, 5}, {40, 5}, "spine"}},
                   {"lower", BoneHandle{{40, 5}, {58, 5}, "upper"}},
                   {"spine", BoneHandle{{2, 5}, {20, 5}, ""}}};
    const auto at = [&](const Eigen::VectorXd& depth, double x) {
        return depth(reference::nearest_vertex(mesh, {x, 5}));
    };
    const Eigen::VectorXd arm = vertex_depths(mesh, rig, with_depths({{"upper", 2}}));
    EXPECT_EQ(at(arm, 30), 2);
    EXPECT_EQ(at(arm, 50), 2);
    EXPECT_EQ(at(arm, 10), 0);
    const Eigen::VectorXd hand = vertex_depths(mesh, rig, with_depths({{"upper", 2}, {"lower", -1}}));
    EXPECT_EQ(at(hand, 30), 2);
    EXPECT_EQ(at(hand, 50), -1);
}

TEST(VertexDepths, OfRegionsAndCagesAreThoseInside) {
    const TriangleMesh mesh = grid(40, 20, 40, 20);
    Rig rig;
    rig.handles = {{"all", CageHandle{{{-1, -1}, {41, -1}, {41, 21}, {-1, 21}}}},
                   {"left", RegionHandle{{{-1, -1}, {10.5, -1}, {10.5, 21}, {-1, 21}}}},
                   {"right", RegionHandle{{{29.5, -1}, {41, -1}, {41, 21}, {29.5, 21}}}}};
    const Eigen::VectorXd depth = vertex_depths(mesh, rig, with_depths({{"right", 1}}));
    for (Eigen::Index v = 0; v < depth.size(); ++v) {
        // Between two straight borders depth is linear, whatever the cage around it, which has none.
        EXPECT_NEAR(depth(v), std::clamp((mesh.V(v, 0) - 10) / 20, 0.0, 1.0), 1e-12);
    }
    // A depth that is given wins over one that is not.
    EXPECT_TRUE((vertex_depths(mesh, rig, with_depths({{"all", 3}})).array() == 3).all());
}

TEST(VertexDepths, BeyondAMillionAreRefused) {
    const Rig rig = reference::rig_of_points({{5, 5}});
    for (const double bad :
         {1.1e6, -1e300, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_THROW(require_sound(with_depths({{"p0", bad}}), rig), InvalidInput) << bad;
    }
    EXPECT_NO_THROW(require_sound(with_depths({{"p0", -1e6}}), rig));
}

}  // namespace
}  // namespace puppetwarp
