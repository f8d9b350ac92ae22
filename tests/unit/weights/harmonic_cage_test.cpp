// Weights of cages that are solved on a mesh, around subjects that their cages are larger than.

#include "cages.h"
#include "reference/test_meshes.h"

#include <puppetwarp/mesh/automatic_cage.h>
#include <puppetwarp/mesh/triangulate.h>

#include <gtest/gtest.h>

namespace puppetwarp {

using namespace tests;

namespace {

Weights weights_of(const TriangleMesh& mesh, const Polyline& cage, WeightKind kind = WeightKind::harmonic_cage) {
    Progress progress;
    WeightOptions options{.kind = kind};
    options.partition = Partition::normalised;
    return compute_weights(mesh, {{cage_handle("hull", cage)}, {}}, options, progress);
}

// How far weights are from those of a square with corners (0, 0), (1, 0), (1, 1), (0, 1), which are bilinear.
double error_from_bilinear(const TriangleMesh& mesh, const Weights& weights) {
    double largest = 0;
    for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
        const double x = mesh.V(v, 0), y = mesh.V(v, 1);
        const Eigen::RowVector4d expected((1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y);
        largest = std::max(largest, (weights.W.row(v) - expected).cwiseAbs().maxCoeff());
    }
    return largest;
}

}  // namespace

TEST(HarmonicCage, OfASquareIsBilinear) {
    const Polyline square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (const double edge : {0.08, 0.04, 0.02, 0.01}) {
        const TriangleMesh mesh = reference::figure(1, edge);
        EXPECT_LT(error_from_bilinear(mesh, weights_of(mesh, square)), edge * edge) << edge;
    }
}

TEST(HarmonicCage, ReproducesLinearMapsAndStaysBetweenZeroAndOne) {
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
        const TriangleMesh mesh = reference::blob(200, 9, seed);
        for (const Polyline& cage :
             {automatic_cage(mesh, 3), automatic_cage(mesh, 20), automatic_cage(mesh, most_cage_corners),
              star({100, 100}, 15, 125, 190, seed), reversed(star({100, 100}, 4, 150, 190, seed))}) {
            const Weights weights = weights_of(mesh, cage);
            EXPECT_LT(weights.partition_error, 1e-10);
            EXPECT_GT(weights.W.minCoeff(), -1e-8);
            EXPECT_LT(weights.W.maxCoeff(), 1 + 1e-8);
            EXPECT_LT((moved_by(weights, cage) - mesh.V).cwiseAbs().maxCoeff(), 1e-10 * 200);
            Polyline sheared = cage;
            for (Point& p : sheared) p = Point(1.3 * p.x() - 0.4 * p.y() + 7, 0.2 * p.x() + 0.8 * p.y() - 3);
            Eigen::MatrixX2d expected(mesh.V.rows(), 2);
            expected << (1.3 * mesh.V.col(0) - 0.4 * mesh.V.col(1)).array() + 7,
                (0.2 * mesh.V.col(0) + 0.8 * mesh.V.col(1)).array() - 3;
            EXPECT_LT((moved_by(weights, sheared) - expected).cwiseAbs().maxCoeff(), 1e-10 * 200);
        }
    }
}

TEST(HarmonicCage, KnowsTheShapeOfTheCage) {
    // A corner beside one arm does not reach into the other, although it is near as the crow flies.
    const Polyline fork{{0, 0}, {20, 0}, {22, 90}, {24, 0}, {44, 0}, {44, 110}, {0, 110}};
    const TriangleMesh mesh =
        triangulate({{{{{2, 2}, {18, 2}, {20, 100}, {24, 100}, {26, 2}, {42, 2}, {42, 108}, {2, 108}}, {}}}}, {},
                    {.max_edge_px = 3});
    const Weights weights = weights_of(mesh, fork);
    const int here = reference::nearest_vertex(mesh, {17, 10}), there = reference::nearest_vertex(mesh, {27, 10});
    EXPECT_GT(weights.W(here, 1), 0.5);
    EXPECT_LT(weights.W(there, 1), 0.01);
}

TEST(CageWeights, OfEveryKindTakeAutomaticCages) {
    const TriangleMesh mesh = reference::figure(1000, 40);
    for (const int corners : {3, 12}) {
        const Polyline cage = automatic_cage(mesh, corners);
        for (const WeightKind kind : {WeightKind::shepard, WeightKind::harmonic, WeightKind::biharmonic,
                                      WeightKind::bbw, WeightKind::l1, WeightKind::monotonic, WeightKind::mean_value,
                                      WeightKind::harmonic_cage, WeightKind::green, WeightKind::cauchy}) {
            const Weights weights = weights_of(mesh, cage, kind);
            EXPECT_EQ(weights.columns.size(), static_cast<std::size_t>(corners));
            EXPECT_TRUE(weights.converged) << weight_kind_name(kind);
            EXPECT_LT(weights.partition_error, 1e-9) << weight_kind_name(kind);
            EXPECT_TRUE(weights.W.allFinite()) << weight_kind_name(kind);
            EXPECT_TRUE(weights.warnings.empty()) << weights.warnings.front();
        }
    }
}

TEST(CageWeights, PinsGoWithACage) {
    const TriangleMesh mesh = reference::blob(200, 9, 2);
    Rig rig{{{"pin", PointHandle{{100, 100}, {}}}, cage_handle("hull", automatic_cage(mesh, 8))}, {}};
    const int held = reference::nearest_vertex(mesh, {100, 100});
    Progress progress;
    for (const WeightKind kind : {WeightKind::harmonic, WeightKind::harmonic_cage, WeightKind::biharmonic,
                                  WeightKind::bbw, WeightKind::monotonic}) {
        const Weights weights = compute_weights(mesh, rig, {.kind = kind}, progress);
        ASSERT_EQ(weights.columns.size(), 9U);
        EXPECT_LT(weights.partition_error, 1e-9);
        // The pin holds a vertex near it, where its weight is 1 and no other has any.
        Eigen::Index top = 0;
        EXPECT_NEAR(weights.W.col(0).maxCoeff(&top), 1, 1e-12);
        EXPECT_LT((mesh.V.row(top) - mesh.V.row(held)).norm(), 10);
        EXPECT_LT(weights.W.row(top).tail(8).cwiseAbs().maxCoeff(), 1e-12);
    }
}

TEST(CageWeights, TakeHundredsOfCorners) {
    // Nearer to each other than the mesh is fine, some hardly bent, on a disc and on an automatic cage.
    const TriangleMesh mesh = reference::blob(200, 16, 3);
    for (const Polyline& cage : {star({100, 100}, 500, 160, 160, 1), automatic_cage(mesh, most_cage_corners)}) {
        const Weights weights = weights_of(mesh, cage);
        EXPECT_LT(weights.partition_error, 1e-10);
        EXPECT_LT((moved_by(weights, cage) - mesh.V).cwiseAbs().maxCoeff(), 1e-8);
    }
}

}  // namespace puppetwarp
