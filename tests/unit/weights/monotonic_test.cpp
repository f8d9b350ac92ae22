#include "reference/test_meshes.h"

#include <puppetwarp/weights/monotonic.h>

#include <gtest/gtest.h>

#include <set>

namespace puppetwarp {
namespace {

using namespace reference;

struct Extrema {
    int maxima = 0;
    int minima = 0;
};

// Free vertices above or below all their neighbours by more than round-off.
Extrema extrema_of(const TriangleMesh& mesh, const std::vector<int>& given, const Eigen::VectorXd& w) {
    std::vector<std::set<int>> around(static_cast<std::size_t>(mesh.V.rows()));
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        for (int k = 0; k < 3; ++k) {
            around[static_cast<std::size_t>(mesh.F(t, k))].insert(mesh.F(t, (k + 1) % 3));
            around[static_cast<std::size_t>(mesh.F(t, k))].insert(mesh.F(t, (k + 2) % 3));
        }
    }
    const std::set<int> held(given.begin(), given.end());
    Extrema found;
    constexpr double round_off = 2e-8;
    for (int v = 0; v < mesh.V.rows(); ++v) {
        if (held.count(v) > 0) continue;
        bool maximum = true, minimum = true;
        for (const int u : around[static_cast<std::size_t>(v)]) {
            maximum &= w(v) > w(u) + round_off;
            minimum &= w(v) < w(u) - round_off;
        }
        found.maxima += maximum;
        found.minima += minimum;
    }
    return found;
}

Rig rig_of(double size) {
    Rig rig = rig_of_points({size * figure_places::head, size * figure_places::left_hand,
                             size * figure_places::right_hand, size * figure_places::left_foot});
    rig.handles.push_back({"spine", BoneHandle{size * figure_places::chest, size * figure_places::belly, ""}});
    return rig;
}

TEST(Monotonic, HasNoExtremaWhereBiharmonicWeightsHaveSome) {
    const TriangleMesh mesh = figure(400, 12);
    const WeightProblem problem(mesh, rig_of(400));
    Progress progress;
    const WeightSolution found = monotonic_functions(problem, {}, progress);
    EXPECT_TRUE(found.converged);
    EXPECT_LE(found.kkt_residual, 1e-8);
    const Eigen::MatrixXd unbounded = unbounded_weights(laplacian_energy(problem), problem.conditions);
    int before = 0;
    for (Eigen::Index j = 0; j < found.W.cols(); ++j) {
        const Extrema after = extrema_of(mesh, problem.conditions.vertices, found.W.col(j));
        EXPECT_EQ(after.maxima, 0) << j;
        EXPECT_EQ(after.minima, 0) << j;
        const Extrema raw = extrema_of(mesh, problem.conditions.vertices, unbounded.col(j));
        before += raw.maxima + raw.minima;
    }
    EXPECT_GT(before, 0) << "the test shows nothing";
    EXPECT_GE(found.W.minCoeff(), 0);
    EXPECT_LE(found.W.maxCoeff(), 1);
}

TEST(Monotonic, LiesBetweenTheHarmonicAndTheUnboundedInEnergy) {
    const TriangleMesh mesh = blob(300, 12, 5);
    const WeightProblem problem(mesh, rig_of_points({{90, 150}, {210, 150}, {150, 220}}));
    Progress progress;
    const SparseMatrix Q = laplacian_energy(problem);
    const Eigen::MatrixXd least = unbounded_weights(Q, problem.conditions);
    const Eigen::MatrixXd harmonic = unbounded_weights(cotangent_stiffness(mesh), problem.conditions);
    const Eigen::MatrixXd found = monotonic_functions(problem, {}, progress).W;
    for (Eigen::Index j = 0; j < found.cols(); ++j) {
        const auto energy = [&](const Eigen::MatrixXd& W) { return W.col(j).dot(Q * W.col(j)); };
        EXPECT_GE(energy(found), energy(least) * (1 - 1e-9));
        EXPECT_LT(energy(found), 0.2 * energy(harmonic));
    }
}

TEST(Monotonic, WhereBiharmonicWeightsAreMonotonicTheyAreTheSame) {
    // Along a strip held by its ends the biharmonic weight is close to x.
    const TriangleMesh mesh = grid(24, 3, 240, 30);
    const Rig rig{{{"a", RegionHandle{{{-1, -1}, {25, -1}, {25, 31}, {-1, 31}}, Falloff::none}},
                   {"b", RegionHandle{{{215, -1}, {241, -1}, {241, 31}, {215, 31}}, Falloff::none}}},
                  {}};
    const WeightProblem problem(mesh, rig);
    Progress progress;
    const Eigen::MatrixXd expected = unbounded_weights(laplacian_energy(problem), problem.conditions);
    for (Eigen::Index j = 0; j < 2; ++j) {
        const Extrema raw = extrema_of(mesh, problem.conditions.vertices, expected.col(j));
        ASSERT_EQ(raw.maxima + raw.minima, 0);
    }
    WeightOptions options;
    options.tolerance = 1e-11;
    EXPECT_LE((monotonic_functions(problem, options, progress).W - expected).cwiseAbs().maxCoeff(), 1e-6);
}

// Constraints that nothing pushes against leave the weights wrong by far more than a loose tolerance.
TEST(Monotonic, ConvergesToWhateverToleranceIsAskedFor) {
    const TriangleMesh mesh = figure(400, 12);
    const WeightProblem problem(mesh, rig_of(400));
    Progress progress;
    const auto solved = [&](double tolerance) {
        WeightOptions options;
        options.tolerance = tolerance;
        const WeightSolution found = monotonic_functions(problem, options, progress);
        EXPECT_TRUE(found.converged) << tolerance;
        return found.W;
    };
    const Eigen::MatrixXd exact = solved(1e-13);
    EXPECT_LE((solved(1e-8) - exact).cwiseAbs().maxCoeff(), 1e-5);
    EXPECT_LE((solved(1e-10) - exact).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(Monotonic, RowsSumToOneAndWorkEndsWhenItIsCancelled) {
    const TriangleMesh mesh = blob(300, 20, 6);
    const WeightProblem problem(mesh, rig_of_points({{90, 150}, {210, 150}, {150, 220}}));
    Progress progress;
    const WeightSolution found = monotonic_weights(problem, {}, progress);
    EXPECT_LE((found.W.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-15);
    struct Unwanted : Progress {
        bool cancelled() const override { return true; }
    } unwanted;
    EXPECT_THROW(monotonic_weights(problem, {}, unwanted), Cancelled);
}

}  // namespace
}  // namespace puppetwarp
