#include "dense_weights.h"
#include "reference/test_meshes.h"

#include <puppetwarp/weights/l1.h>

#include <gtest/gtest.h>

namespace puppetwarp {
namespace {

double free_integral(const WeightProblem& problem, const Eigen::VectorXd& w) {
    Eigen::VectorXd mass = lumped_mass(problem.mesh);
    for (const int v : problem.conditions.vertices) mass(v) = 0;
    return mass.dot(w);
}

WeightSolution functions(const WeightProblem& problem, double budget) {
    WeightOptions options;
    options.l1_budget = budget;
    Progress progress;
    return l1_functions(problem, options, progress);
}

TEST(L1, KeepsToItsBudgetAndUsesIt) {
    const TriangleMesh mesh = reference::blob(300, 12, 3);
    const WeightProblem problem(mesh, reference::rig_of_points({{80, 150}, {220, 150}, {150, 70}}));
    const WeightSolution whole = functions(problem, 1);
    for (const double budget : {0.7, 0.4, 0.1}) {
        const WeightSolution found = functions(problem, budget);
        EXPECT_TRUE(found.converged);
        for (Eigen::Index j = 0; j < found.W.cols(); ++j) {
            const double share = free_integral(problem, found.W.col(j)) / free_integral(problem, whole.W.col(j));
            EXPECT_LE(share, budget);
            EXPECT_GE(share, 0.999 * budget);
        }
    }
}

// A lone handle has 1 everywhere without a budget, which bends nothing.
TEST(L1, KeepsToItsBudgetWhereWeightsAreConstant) {
    const WeightProblem problem(reference::blob(300, 15, 4), reference::rig_of_points({{150, 150}}));
    const WeightSolution found = functions(problem, 0.5);
    EXPECT_TRUE(found.converged);
    const double share =
        free_integral(problem, found.W.col(0)) / free_integral(problem, functions(problem, 1).W.col(0));
    EXPECT_LE(share, 0.5);
    EXPECT_GE(share, 0.999 * 0.5);
}

// What no handle reaches takes part of what is around it: harmonic weights, rows still sum to 1.
TEST(L1, WhatNoHandleReachesIsHarmonic) {
    const TriangleMesh mesh = reference::grid(40, 6, 400, 60);
    const WeightProblem problem(mesh, reference::rig_of_points({{20, 30}, {380, 30}}));
    WeightOptions options;
    options.l1_budget = 0.02;
    Progress progress;
    const Eigen::MatrixXd alone = l1_functions(problem, options, progress).W;
    const Eigen::MatrixXd W = l1_weights(problem, options, progress).W;
    const Eigen::MatrixXd flow = cotangent_stiffness(mesh) * W;
    int unreached = 0;
    for (Eigen::Index v = 0; v < W.rows(); ++v) {
        EXPECT_NEAR(W.row(v).sum(), 1, 1e-12);
        if (alone.row(v).sum() > 0) continue;
        ++unreached;
        EXPECT_LT(flow.row(v).cwiseAbs().maxCoeff(), 1e-12);
    }
    EXPECT_GT(unreached, 50);
}

TEST(L1, SupportShrinksWithTheBudget) {
    const TriangleMesh mesh = reference::grid(60, 10, 600, 100);
    const WeightProblem problem(mesh, reference::rig_of_points({{50, 50}, {550, 50}}));
    const auto reach = [&](double budget) {
        const Eigen::MatrixXd W = functions(problem, budget).W;
        double farthest = 0;
        for (int v = 0; v < mesh.V.rows(); ++v) {
            if (W(v, 0) > 0) farthest = std::max(farthest, mesh.V(v, 0));
        }
        return farthest;
    };
    EXPECT_LT(reach(0.5), 500);
    EXPECT_LT(reach(0.2), reach(0.5) - 100);
}

// The multiplier is the price of the integral: with it in the energy, the budget is forgotten by a dense method.
TEST(L1, IsTheMinimumForThePriceOfItsIntegral) {
    const TriangleMesh mesh = reference::grid(15, 12, 150, 120, 0.2, 4);
    const WeightProblem problem(mesh, reference::rig_of_points({{20, 20}, {130, 100}, {30, 110}}));
    const Eigen::MatrixXd W = functions(problem, 0.6).W;
    const SparseMatrix Q = laplacian_energy(problem);
    const Eigen::VectorXd mass = lumped_mass(mesh);
    for (Eigen::Index j = 0; j < W.cols(); ++j) {
        // Read off a vertex well between the bounds.
        const Eigen::VectorXd g = Q * W.col(j);
        Eigen::Index inner = 0;
        double most = 0;
        for (Eigen::Index v = 0; v < W.rows(); ++v) {
            const bool given = std::find(problem.conditions.vertices.begin(), problem.conditions.vertices.end(),
                                         static_cast<int>(v)) != problem.conditions.vertices.end();
            if (!given && W(v, j) < 0.9 && W(v, j) > most) {
                most = W(v, j);
                inner = v;
            }
        }
        const double price = -g(inner) / mass(inner);
        ASSERT_GT(price, 0);
        const DenseWeightProblem dense{Q, price * mass, problem.conditions.vertices, problem.conditions.values.col(j),
                                       false};
        EXPECT_LE((dense_weights(dense) - W.col(j)).cwiseAbs().maxCoeff(), 1e-6) << j;
    }
}

TEST(L1, ProgressOnlyGrowsAndRowsSumToOne) {
    class Heard : public Progress {
    public:
        std::vector<double> fractions;

    protected:
        void show(std::string_view, double fraction) override { fractions.push_back(fraction); }
    } heard;
    const TriangleMesh mesh = reference::blob(400, 10, 3);
    const WeightProblem problem(mesh, reference::rig_of_points({{120, 200}, {280, 200}}));
    const WeightSolution found = l1_weights(problem, {}, heard);
    EXPECT_TRUE(std::is_sorted(heard.fractions.begin(), heard.fractions.end()));
    EXPECT_GT(heard.fractions.size(), 4u);
    EXPECT_LE((found.W.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-12);
    EXPECT_GE(found.W.minCoeff(), 0);
}

}  // namespace
}  // namespace puppetwarp
