#include "reference/test_meshes.h"
#include "support/message_of.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/weights/weight_conditions.h>

#include <gtest/gtest.h>

#include <cmath>

namespace puppetwarp {
namespace {

using reference::grid;

// 20 x 10 squares of 10 px; vertex (i, j) has index 21 j + i.
const TriangleMesh& board() {
    static const TriangleMesh mesh = grid(20, 10, 200, 100);
    return mesh;
}

int at(int i, int j) {
    return 21 * j + i;
}

Handle bone(const std::string& id, const Point& from, const Point& to) {
    return {id, BoneHandle{from, to, ""}};
}

Handle point(const std::string& id, const Point& place) {
    return {id, PointHandle{place, {}}};
}

std::vector<int> held_by(const WeightConditions& conditions, Eigen::Index column) {
    std::vector<int> vertices;
    for (std::size_t i = 0; i < conditions.vertices.size(); ++i) {
        if (conditions.values(static_cast<Eigen::Index>(i), column) == 1) vertices.push_back(conditions.vertices[i]);
    }
    return vertices;
}

TEST(WeightConditions, APointHoldsTheNearestCornerOfItsTriangle) {
    const WeightConditions conditions =
        weight_conditions(board(), {{point("a", {31, 42}), point("b", {200, 100})}, {}});
    EXPECT_EQ(conditions.vertices, (std::vector<int>{at(3, 4), at(20, 10)}));
    EXPECT_EQ(conditions.values, Eigen::MatrixXd::Identity(2, 2));
}

// Ties at the middles of edges, which and on diagonals, which round-off would settle in another way at every size.
TEST(WeightConditions, TheSameVerticesAreHeldAtEverySizeAndPlace) {
    for (const double scale : {1.0, 1e-6, 0.01 / 3, 7.7, 1e6}) {
        for (const Point& shift : {Point(0, 0), Point(0.1, 0.7), Point(333, -77)}) {
            SCOPED_TRACE(scale);
            TriangleMesh mesh = grid(12, 12, 100, 100);
            const auto moved = [&](const Point& p) { return Point(scale * (p + shift)); };
            for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) mesh.V.row(v) = moved(mesh.V.row(v).transpose());
            const Rig rig{{point("p", moved({340 / 12.0, 20})), point("q", moved({62.5, 87.5})),
                           point("r", moved({50, 87.5})), bone("b", moved({20, 45}), moved({80, 60}))},
                          {}};
            const WeightConditions conditions = weight_conditions(mesh, rig);
            EXPECT_EQ(held_by(conditions, 0), std::vector<int>{13 * 2 + 4});
            EXPECT_EQ(held_by(conditions, 1), std::vector<int>{13 * 10 + 8});
            EXPECT_EQ(held_by(conditions, 2), std::vector<int>{13 * 10 + 6});
            EXPECT_EQ(held_by(conditions, 3).back(), 13 * 7 + 9);
        }
    }
}

TEST(WeightConditions, ABoneHoldsTheVerticesAlongIt) {
    const WeightConditions conditions = weight_conditions(board(), {{bone("a", {20, 50}, {70, 50})}, {}});
    EXPECT_EQ(conditions.vertices, (std::vector<int>{at(2, 5), at(3, 5), at(4, 5), at(5, 5), at(6, 5), at(7, 5)}));
}

TEST(WeightConditions, BonesLeaveTheirJointFree) {
    const Rig rig{{bone("a", {20, 50}, {100, 50}), bone("b", {100, 50}, {100, 90})}, {}};
    const TriangleMesh fine = grid(200, 100, 200, 100);
    const WeightConditions conditions = weight_conditions(fine, rig);
    ASSERT_FALSE(held_by(conditions, 0).empty());
    const double free = 100 - fine.V.row(held_by(conditions, 0).back()).x();
    EXPECT_GT(free, 0.015 * bounding_diagonal(fine.V));
    EXPECT_LT(free, 0.025 * bounding_diagonal(fine.V));
    for (const int v : held_by(conditions, 1)) EXPECT_GE(fine.V(v, 1) - 50, free - 1e-9);
}

TEST(WeightConditions, ABoneEndingOnAnotherFreesBothThere) {
    const Rig rig{{bone("a", {20, 50}, {180, 50}), bone("b", {100, 50}, {100, 90})}, {}};
    const TriangleMesh fine = grid(200, 100, 200, 100);
    const WeightConditions conditions = weight_conditions(fine, rig);
    for (const Eigen::Index column : {0, 1}) {
        for (const int v : held_by(conditions, column)) {
            EXPECT_GT((fine.V.row(v) - Eigen::RowVector2d(100, 50)).norm(), 0.015 * bounding_diagonal(fine.V));
        }
    }
}

// Edges with no vertex between their ends, as about a slit.
TEST(WeightConditions, CornersOfShortEdgesOfACageHoldTheirVertex) {
    const Rig rig{{{"hull", CageHandle{{{0, 0}, {200, 0}, {200, 100}, {110, 100}, {100, 100}, {0, 100}}}}}, {}};
    const WeightConditions conditions = weight_conditions(board(), rig);
    EXPECT_EQ(held_by(conditions, 3), std::vector<int>{at(11, 10)});
    EXPECT_EQ(held_by(conditions, 4), std::vector<int>{at(10, 10)});
    EXPECT_EQ(conditions.vertices.size(), 60u);
    EXPECT_LT((conditions.values.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-15);
}

TEST(WeightConditions, AVertexOfNoHandlesComponentGoesToTheNearest) {
    const TriangleMesh two = reference::joined(grid(4, 4, 40, 40), grid(4, 4, 40, 40), {100, 0});
    const WeightConditions conditions = weight_conditions(two, {{point("far", {0, 0}), point("near", {40, 20})}, {}});
    EXPECT_EQ(held_by(conditions, 0).size(), 1u);
    EXPECT_EQ(held_by(conditions, 1).size(), 26u);
    ASSERT_EQ(conditions.warnings.size(), 1u);
    EXPECT_NE(conditions.warnings[0].find("'near'"), std::string::npos) << conditions.warnings[0];
}

TEST(WeightConditions, RefusesWhatCannotBe) {
    const auto refusal = [](const std::vector<Handle>& handles) {
        return message_of([&] { weight_conditions(board(), {handles, {}}); });
    };
    EXPECT_EQ(
        refusal({bone("a", {20, 50}, {100, 50}), bone("b", {60, 20}, {60, 80})}),
        "handles 'a' and 'b': the bones cross each other at (60, 50) (let them meet at an end, or move them apart)");
    EXPECT_EQ(refusal({point("a", {20, 50}), point("b", {21, 51})}),
              "handles 'a' and 'b': they hold one vertex of the mesh, at (20, 50) (move them apart, or make the mesh "
              "finer)");
    EXPECT_EQ(refusal({point("a", {20, 150})}),
              "handle 'a': lies 50 px outside the subject (--pin-snap PX moves it onto the subject)");
    EXPECT_EQ(refusal({bone("a", {20, 50}, {220, 50})}),
              "handle 'a': lies 20 px outside the subject (--pin-snap PX moves it onto the subject)");
    EXPECT_EQ(
        refusal({{"r", RegionHandle{{{12, 12}, {15, 12}, {12, 15}}, Falloff::none}}}),
        "handle 'r': no vertex of the mesh lies inside the region (draw it larger and on the subject, or make the "
        "mesh finer)");
    EXPECT_EQ(refusal({bone("a", {20, 50}, {100, 50}), bone("b", {100, 50}, {20, 50})}),
              "handle 'a': it holds no vertex of the mesh that it does not share (move it away from the others, or "
              "make the mesh finer)");
    EXPECT_EQ(refusal({{"v", VertexHandle{231}}}), "handle 'v': index 231 is not a vertex: the mesh has 231");
}

TEST(Weights, HoldNoMinusZero) {
    WeightOptions options;
    options.partition = Partition::normalised;
    const Rig rig{{point("a", {10, 50}), point("b", {60, 50}), point("c", {140, 20}), bone("d", {170, 20}, {170, 80})},
                  {}};
    Progress progress;
    const Weights weights = compute_weights(board(), rig, options, progress);
    EXPECT_GT((weights.W.array() == 0).count(), 100);
    EXPECT_FALSE(weights.W.unaryExpr([](double w) { return std::signbit(w) ? 1.0 : 0.0; }).any());
}

}  // namespace
}  // namespace puppetwarp
