// Cages that are not made of the subject's edges: weights are solved on all that the subject or a cage holds.
#include "cages.h"
#include "reference/test_meshes.h"

#include <puppetwarp/mesh/triangulate.h>
#include <puppetwarp/rig/region.h>
#include <puppetwarp/weights/weight_domain.h>

#include <gtest/gtest.h>

namespace puppetwarp {

using namespace tests;

namespace {

Weights weights_of(const TriangleMesh& mesh, const Rig& rig, WeightKind kind) {
    Progress progress;
    const Weights found = compute_weights(mesh, rig, {.kind = kind}, progress);
    EXPECT_TRUE(found.converged);
    EXPECT_LE(found.partition_error, 1e-9);
    return found;
}

// Harmonic weights that are linear on the cage reproduce linear functions exactly, on any mesh that fills it.
TEST(WeightDomain, HarmonicWeightsOfACageAroundTheSubjectAreLinearlyPrecise) {
    for (std::uint32_t seed = 1; seed <= 6; ++seed) {
        const TriangleMesh mesh = reference::blob(200, 14, seed);
        const Polyline cage = star({100, 100}, 5 + 2 * static_cast<int>(seed), 125, 190, seed);
        const Weights weights = weights_of(mesh, {{cage_handle("hull", cage)}, {}}, WeightKind::harmonic_cage);
        ASSERT_EQ(weights.W.rows(), mesh.V.rows());
        EXPECT_LT((moved_by(weights, cage) - mesh.V).cwiseAbs().maxCoeff(), 1e-10) << seed;
    }
}

// Two fingers in one convex cage: weights of the cage do not hear of the slit between.
TEST(WeightDomain, WithinACageTheSubjectsBoundaryIsNoMore) {
    const Polyline cage{{-20, -20}, {64, -20}, {64, 150}, {-20, 150}};
    const Rig rig{{cage_handle("hull", cage)}, {}};
    const Polyline outline{{0, 0}, {20, 0}, {20, 100}, {24, 100}, {24, 0}, {44, 0}, {44, 130}, {0, 130}};
    const TriangleMesh fingers = triangulate({{{outline, {}}}}, {}, {5});
    const TriangleMesh full = triangulate({{{cage, {}}}}, {{{20, 0}, {20, 100}}, {{24, 0}, {24, 100}}}, {5});
    for (const WeightKind kind : {WeightKind::harmonic_cage, WeightKind::bbw}) {
        const Weights of_fingers = weights_of(fingers, rig, kind), of_all = weights_of(full, rig, kind);
        double most = 0, across = 0;
        for (double y = 5; y < 100; y += 10) {
            const auto at = [&](const TriangleMesh& mesh, const Weights& weights, double x) {
                return weights.W.row(reference::nearest_vertex(mesh, {x, y})).eval();
            };
            const int here = reference::nearest_vertex(fingers, {20, y});
            const Point p = fingers.V.row(here).transpose();
            most = std::max(
                most,
                (of_fingers.W.row(here) - of_all.W.row(reference::nearest_vertex(full, p))).cwiseAbs().maxCoeff());
            across =
                std::max(across, (at(fingers, of_fingers, 20) - at(fingers, of_fingers, 24)).cwiseAbs().maxCoeff());
        }
        // A vertex of the other mesh is at most an edge away, over which weights change by that share of the cage.
        EXPECT_LT(most, 0.1) << weight_kind_name(kind);
        EXPECT_LT(across, 0.15) << weight_kind_name(kind);
    }
}

TEST(WeightDomain, ACageMadeOfTheMeshLeavesItAsItIs) {
    const TriangleMesh mesh = reference::grid(10, 10, 100, 100);
    const Polyline inner{{20, 20}, {80, 20}, {80, 80}, {20, 80}};
    EXPECT_FALSE(weight_domain(mesh, {{cage_handle("hull", inner)}, {}}).carry);
    EXPECT_FALSE(weight_domain(mesh, reference::rig_of_points({{50, 50}})).carry);
    const Polyline off{{21, 21}, {79, 20}, {80, 80}, {20, 80}};
    EXPECT_TRUE(weight_domain(mesh, {{cage_handle("hull", off)}, {}}).carry);
}

TEST(WeightDomain, CarriesToEachVertexWhatIsSolvedThere) {
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
        const TriangleMesh mesh = reference::blob(200, 14, seed);
        const std::vector<Polyline> cages{star({100, 100}, 9, 130, 180, seed), star({150, 110}, 9, 60, 90, seed),
                                          star({100, 100}, 7, 25, 45, seed)};
        for (const Polyline& cage : cages) {
            Rig rig{{cage_handle("hull", cage), {"v", VertexHandle{0}}}, {}};
            const bool around = cage == cages.front();
            // A vertex that no cage crowds.
            const int far = reference::nearest_vertex(mesh, {100, 100});
            std::get<VertexHandle>(rig.handles[1].shape).index = far;
            const WeightDomain domain = weight_domain(mesh, rig);
            ASSERT_TRUE(domain.carry);
            // Linear functions come back as they are, but for some vertices where the boundary meets a cage inside.
            const Eigen::VectorXd off = (*domain.carry * domain.mesh.V - mesh.V).rowwise().norm();
            EXPECT_LE(off.maxCoeff(), around ? 1e-9 : 14);
            EXPECT_LE((off.array() > 1e-9).count(), 4);  // where it crosses twice
            const int index = std::get<VertexHandle>(domain.rig.handles[1].shape).index;
            EXPECT_LT((domain.mesh.V.row(index) - mesh.V.row(far)).norm(), 1e-12);
            const Weights weights = weights_of(mesh, rig, WeightKind::bbw);
            EXPECT_GE(weights.W.minCoeff(), 0);
            EXPECT_LE(weights.W.maxCoeff(), 1 + 1e-15);
            EXPECT_NEAR(weights.W(far, weights.W.cols() - 1), 1, 1e-12);
        }
    }
}

// Vertices of the mesh beside a corner follow it, those inside by the cage alone.
TEST(WeightDomain, ACagePartlyInsideHoldsItsEdges) {
    const TriangleMesh mesh = reference::grid(40, 40, 200, 200, 0.2, 3);
    const Polyline cage = star({200, 100}, 8, 60, 80, 5);
    const Weights weights = weights_of(mesh, {{cage_handle("hull", cage)}, {}}, WeightKind::bbw);
    for (std::size_t k = 0; k < cage.size(); ++k) {
        if (cage[k].x() > 195 || cage[k].x() < 5) continue;
        const int vertex = reference::nearest_vertex(mesh, cage[k]);
        const double away = (mesh.V.row(vertex).transpose() - cage[k]).norm();
        // The edges beside a corner are some 50 px long, along which its weight falls from 1 to 0.
        EXPECT_GT(weights.W(vertex, static_cast<Eigen::Index>(k)), 1 - 3 * away / 40) << k;
    }
}

}  // namespace
}  // namespace puppetwarp
