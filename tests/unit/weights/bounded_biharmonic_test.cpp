#include "dense_weights.h"
#include "reference/test_meshes.h"

#include <puppetwarp/mesh/locate.h>
#include <puppetwarp/mesh/triangulate.h>
#include <puppetwarp/weights/weight_problem.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

namespace puppetwarp {
namespace {

using reference::grid;

Handle point(const std::string& id, const Point& at) {
    return {id, PointHandle{at, {}}};
}

Handle bone(const std::string& id, const Point& from, const Point& to) {
    return {id, BoneHandle{from, to, ""}};
}

WeightOptions options_of(Partition partition) {
    WeightOptions options;
    options.partition = partition;
    return options;
}

Weights solve(const TriangleMesh& mesh, const Rig& rig, Partition partition) {
    Progress progress;
    return compute_weights(mesh, rig, options_of(partition), progress);
}

// What the dense method finds, divided by the sums of rows.
Eigen::MatrixXd reference_weights(const TriangleMesh& mesh, const Rig& rig, Partition partition) {
    const WeightProblem problem(mesh, rig);
    DenseWeightProblem dense{laplacian_energy(problem), Eigen::VectorXd::Zero(mesh.V.rows()),
                             problem.conditions.vertices, problem.conditions.values, partition == Partition::coupled};
    Eigen::MatrixXd W = dense_weights(dense);
    W.array().colwise() /= Eigen::VectorXd(W.rowwise().sum()).array();
    return W;
}

double energy(const TriangleMesh& mesh, const Rig& rig, const Eigen::MatrixXd& W) {
    return 0.5 * W.cwiseProduct(laplacian_energy(WeightProblem(mesh, rig)) * W).sum();
}

struct Scene {
    std::string name;
    TriangleMesh mesh;
    Rig rig;
};

// 300 vertices each: points, bones that share a joint, a region, a cage around all, all kinds mixed, stiffness.
std::vector<Scene> scenes() {
    const TriangleMesh board = grid(19, 14, 190, 140, 0.25, 3);
    const TriangleMesh squares = grid(19, 14, 190, 140);
    std::vector<Scene> all;
    all.push_back({"points", board, {{point("a", {10, 10}), point("b", {180, 30}), point("c", {90, 120})}, {}}});
    all.push_back(
        {"bones", board, {{bone("a", {20, 30}, {90, 70}), bone("b", {90, 70}, {170, 60}), point("c", {40, 120})}, {}}});
    all.push_back({"region",
                   board,
                   {{{"r", RegionHandle{{{20, 20}, {70, 20}, {70, 60}, {20, 60}}, Falloff::none}},
                     point("b", {180, 130}),
                     point("c", {170, 20})},
                    {}}});
    all.push_back({"cage",
                   squares,
                   {{{"hull", CageHandle{{{0, 0}, {190, 0}, {190, 140}, {0, 140}}}}, point("b", {100, 70})}, {}}});
    all.push_back({"mixed",
                   squares,
                   {{{"hull", CageHandle{{{120, 50}, {170, 50}, {170, 110}, {120, 110}}}},
                     point("a", {20, 20}),
                     bone("b", {80, 20}, {80, 60}),
                     {"r", RegionHandle{{{25, 85}, {65, 85}, {65, 115}, {25, 115}}, Falloff::none}}},
                    {}}});
    Rig stiff = all[0].rig;
    stiff.stiffness.emplace_back(StiffnessRegion{{{60, 20}, {120, 20}, {120, 90}, {60, 90}}, 101});
    all.push_back({"stiffness", board, stiff});
    return all;
}

class BoundedBiharmonic : public testing::TestWithParam<Partition> {};

TEST_P(BoundedBiharmonic, IsWhatADenseInteriorPointMethodFinds) {
    for (const Scene& scene : scenes()) {
        SCOPED_TRACE(scene.name);
        const Weights weights = solve(scene.mesh, scene.rig, GetParam());
        EXPECT_TRUE(weights.converged);
        EXPECT_LE(weights.kkt_residual, 1e-8);
        EXPECT_GE(weights.W.minCoeff(), 0);
        EXPECT_LE(weights.W.maxCoeff(), 1);
        EXPECT_LE(weights.partition_error, 1e-9);
        const Eigen::MatrixXd expected = reference_weights(scene.mesh, scene.rig, GetParam());
        EXPECT_LT((weights.W - expected).cwiseAbs().maxCoeff(), 1e-6);
    }
}

// 2000 vertices: the solve goes through coarse meshes.
TEST_P(BoundedBiharmonic, MirroredInputGivesMirroredWeights) {
    const TriangleMesh mesh = reference::blob(500, 8, 4);
    ASSERT_GT(mesh.V.rows(), 1200);
    const Rig rig = reference::rig_of_vertices({3, 400, 900, 1100});
    TriangleMesh mirrored = mesh;
    mirrored.V.col(0) = 500 - mesh.V.col(0).array();
    const Weights weights = solve(mesh, rig, GetParam()), other = solve(mirrored, rig, GetParam());
    EXPECT_LT((weights.W - other.W).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_P(BoundedBiharmonic, DoesNotDependOnUnitsOrPlace) {
    const TriangleMesh mesh = reference::blob(500, 12, 9);
    const Rig rig = reference::rig_of_vertices({3, 200, 400});
    TriangleMesh other = mesh;
    other.V = (mesh.V * 1e-3).rowwise() + Eigen::RowVector2d(7, -2);
    EXPECT_LT((solve(mesh, rig, GetParam()).W - solve(other, rig, GetParam()).W).cwiseAbs().maxCoeff(), 1e-8);
}

TEST_P(BoundedBiharmonic, HoldsWhereNothingIsFree) {
    const TriangleMesh mesh = grid(1, 1, 10, 10);
    const Weights all = solve(mesh, reference::rig_of_vertices({0, 1, 2, 3}), GetParam());
    EXPECT_EQ(all.W, Eigen::MatrixXd::Identity(4, 4));
    EXPECT_TRUE(all.converged);
    const Weights one = solve(grid(30, 30, 10, 10), reference::rig_of_vertices({17}), GetParam());
    EXPECT_LT((one.W.array() - 1).abs().maxCoeff(), 1e-12);
    const Weights lone = solve(reference::joined(grid(30, 20, 30, 20), grid(20, 30, 20, 30), {100, 0}),
                               reference::rig_of_vertices({0, 300}), GetParam());
    EXPECT_EQ(lone.W.row(900), Eigen::RowVector2d(0, 1));
    EXPECT_EQ(lone.warnings.size(), 1u);
    EXPECT_TRUE(lone.converged);
}

// Bones that share a joint are the hard case: held to their ends, their energy grows fourfold with each refinement.
TEST_P(BoundedBiharmonic, ConvergesUnderRefinement) {
    const Rig rig{{bone("a", {100, 300}, {500, 300}), bone("b", {500, 300}, {900, 450}), point("c", {500, 550})}, {}};
    struct Level {
        Eigen::MatrixXd samples;
        double energy;
    };
    const auto at_edge = [&](double edge) {
        const TriangleMesh mesh =
            triangulate(rectangle_outline(1000, 600), {{{100, 300}, {500, 300}, {900, 450}}, {{500, 550}}}, {edge});
        const Weights weights = solve(mesh, rig, GetParam());
        const MeshLocator locator(mesh);
        Eigen::MatrixXd samples = Eigen::MatrixXd::Zero(240, 3);
        for (int k = 0; k < 240; ++k) {
            const MeshLocation place = locator.locate({25.0 + 50 * (k % 20), 25.0 + 50 * (k / 20)});
            for (int c = 0; c < 3; ++c) {
                samples.row(k) += place.barycentric(c) * weights.W.row(mesh.F(place.triangle, c));
            }
        }
        return Level{samples, energy(mesh, rig, weights.W)};
    };
    const Level coarse = at_edge(30), fine = at_edge(15);
    EXPECT_LT((fine.samples - coarse.samples).norm() / std::sqrt(240), 0.015);
    EXPECT_LT((fine.samples - coarse.samples).cwiseAbs().maxCoeff(), 0.04);
    EXPECT_LT(fine.energy, 1.5 * coarse.energy);
}

TEST_P(BoundedBiharmonic, SettlesOnRandomSubjectsWithoutAFallback) {
    std::mt19937 random(7);
    for (std::uint32_t seed = 1; seed <= 6; ++seed) {
        const TriangleMesh mesh = reference::blob(400, 12, seed);
        std::vector<int> indices;
        for (int k = 0; k < 6; ++k) {
            const int v = static_cast<int>(random() % static_cast<std::uint32_t>(mesh.V.rows()));
            if (std::find(indices.begin(), indices.end(), v) == indices.end()) indices.push_back(v);
        }
        const Weights weights = solve(mesh, reference::rig_of_vertices(indices), GetParam());
        EXPECT_TRUE(weights.converged) << seed;
        EXPECT_LE(weights.kkt_residual, 1e-8) << seed;
        EXPECT_EQ(weights.fallback, "") << seed;
        EXPECT_LE(weights.partition_error, 1e-9) << seed;
    }
}

// Sixty points: each is 0 beyond its neighbours and theirs.
TEST_P(BoundedBiharmonic, TakesManyHandles) {
    const TriangleMesh mesh = grid(40, 30, 400, 300, 0.2, 6);
    std::vector<int> indices;
    for (int k = 0; k < 60; ++k) indices.push_back(41 * (2 + 5 * (k / 10)) + 2 + 4 * (k % 10));
    const Weights weights = solve(mesh, reference::rig_of_vertices(indices), GetParam());
    EXPECT_TRUE(weights.converged);
    EXPECT_LE(weights.kkt_residual, 1e-8);
    EXPECT_EQ(weights.fallback, "");
    EXPECT_LE(weights.partition_error, 1e-9);
    EXPECT_LT(static_cast<double>((weights.W.array() > 1e-9).count()) / static_cast<double>(mesh.V.rows()), 20);
}

TEST_P(BoundedBiharmonic, SaysWhenItStopsBeforeTheEnd) {
    const TriangleMesh mesh = reference::blob(400, 12, 2);
    WeightOptions options = options_of(GetParam());
    options.max_iterations = 1;
    Progress progress;
    const Weights weights = compute_weights(mesh, reference::rig_of_vertices({3, 200, 400}), options, progress);
    EXPECT_FALSE(weights.converged);
    EXPECT_GT(weights.kkt_residual, options.tolerance);
    EXPECT_GE(weights.W.minCoeff(), 0);
    EXPECT_LE(weights.partition_error, 1e-9);
}

// Hears of the work, and ends it after some steps.
class Listener : public Progress {
public:
    explicit Listener(int patience) : patience_(patience) {}
    bool cancelled() const override { return static_cast<int>(fractions.size()) >= patience_; }
    std::vector<double> fractions;

protected:
    void show(std::string_view stage, double fraction) override {
        EXPECT_EQ(stage, "weights");
        fractions.push_back(fraction);
    }

private:
    int patience_;
};

TEST_P(BoundedBiharmonic, ReportsProgressAndCanBeCancelled) {
    const TriangleMesh mesh = reference::blob(400, 12, 2);
    const Rig rig = reference::rig_of_vertices({3, 200, 400});
    Listener patient(1000000);
    compute_weights(mesh, rig, options_of(GetParam()), patient);
    EXPECT_GT(patient.fractions.size(), 4u);
    EXPECT_TRUE(std::is_sorted(patient.fractions.begin(), patient.fractions.end()));
    EXPECT_EQ(patient.fractions.back(), 1);
    Listener impatient(3);
    EXPECT_THROW(compute_weights(mesh, rig, options_of(GetParam()), impatient), Cancelled);
}

INSTANTIATE_TEST_SUITE_P(Partitions, BoundedBiharmonic, testing::Values(Partition::coupled, Partition::normalised),
                         [](const auto& tested) { return partition_name(tested.param); });

TEST(BoundedBiharmonicCoupled, CostsLessThanNormalised) {
    for (const Scene& scene : scenes()) {
        const double coupled = energy(scene.mesh, scene.rig, solve(scene.mesh, scene.rig, Partition::coupled).W);
        const double normalised = energy(scene.mesh, scene.rig, solve(scene.mesh, scene.rig, Partition::normalised).W);
        EXPECT_LE(coupled, normalised * (1 + 1e-12)) << scene.name;
    }
}

// Q = diagonal^2 L M^-1 L + L(rho): the parts by other means than the library's.
TEST(LaplacianEnergy, AddsTheDirichletEnergyOfStiffTriangles) {
    const TriangleMesh mesh = grid(12, 9, 120, 90, 0.25, 3);
    Rig rig = reference::rig_of_vertices({0, 50});
    const SparseMatrix plain = laplacian_energy(WeightProblem(mesh, rig));
    rig.stiffness.emplace_back(StiffnessRegion{{{-1, -1}, {60, -1}, {60, 91}, {-1, 91}}, 11});
    rig.stiffness.emplace_back(StiffnessRegion{{{60, -1}, {121, -1}, {121, 91}, {60, 91}}, 0.5});
    const SparseMatrix stiff = laplacian_energy(WeightProblem(mesh, rig));
    // rho = 10 in the left half: the energy of x there is 10 times its area; below 1 nothing is taken away.
    double area = 0;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        const double x = (mesh.V(mesh.F(t, 0), 0) + mesh.V(mesh.F(t, 1), 0) + mesh.V(mesh.F(t, 2), 0)) / 3;
        if (x < 60) area += 0.5 * std::abs(double_areas(mesh.V, mesh.F)(t));
    }
    const Eigen::VectorXd x = mesh.V.col(0);
    EXPECT_NEAR(x.dot(stiff * x) - x.dot(plain * x), 10 * area, 1e-8 * x.dot(plain * x));
    // Of x^2 + y^2 the Laplacian is 4 inside: a sum over vertices whose patches are inside.
    const TriangleMesh square = grid(40, 40, 1, 1);
    const SparseMatrix Q = laplacian_energy(WeightProblem(square, reference::rig_of_vertices({0, 50})));
    const Eigen::VectorXd q = square.V.rowwise().squaredNorm();
    const Eigen::VectorXd Qq = Q * q;
    EXPECT_NEAR(Qq(20 * 41 + 20), 0, 1e-8 * Q.coeff(20 * 41 + 20, 20 * 41 + 20));
    EXPECT_GT(q.dot(Qq), 0);
}

}  // namespace
}  // namespace puppetwarp
