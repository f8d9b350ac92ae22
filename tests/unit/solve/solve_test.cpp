#include "reference/test_meshes.h"

#include <puppetwarp/mesh/operators.h>
#include <puppetwarp/solve/cholesky.h>
#include <puppetwarp/solve/constraint_space.h>
#include <puppetwarp/solve/grounded_inverse.h>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <random>

namespace puppetwarp {
namespace {

SparseMatrix random_symmetric(int n, std::uint32_t seed, double diagonal) {
    std::mt19937 random(seed);
    const auto index = [&] { return static_cast<int>(random() % static_cast<std::uint32_t>(n)); };
    std::vector<Eigen::Triplet<double>> entries;
    for (int k = 0; k < 4 * n; ++k) {
        const int i = index(), j = index();
        const double value = static_cast<double>(random()) / 4294967296.0 - 0.5;
        entries.emplace_back(i, j, value);
        entries.emplace_back(j, i, value);
    }
    for (int i = 0; i < n; ++i) entries.emplace_back(i, i, diagonal);
    SparseMatrix A(n, n);
    A.setFromTriplets(entries.begin(), entries.end());
    return A;
}

TEST(Cholesky, SolvesWhatADenseSolverSolves) {
    for (const int n : {1, 2, 17, 120}) {
        const SparseMatrix A = random_symmetric(n, 5, 12);
        const SparseMatrix lower = A.triangularView<Eigen::Lower>();
        const auto factor = CholeskyPattern(lower).factorise(lower);
        ASSERT_TRUE(factor);
        EXPECT_EQ(factor->size(), n);
        Eigen::VectorXcd b(n);
        for (int i = 0; i < n; ++i) b(i) = {std::sin(i + 1.0), std::cos(3.0 * i)};
        const Eigen::VectorXcd expected = Eigen::MatrixXd(A).cast<std::complex<double>>().partialPivLu().solve(b);
        Eigen::VectorXcd x = b;
        factor->solve_in_place(x);
        EXPECT_LT((x - expected).norm(), 1e-12 * (1 + expected.norm()));
        Eigen::VectorXd re = b.real();
        factor->solve_in_place(re);
        EXPECT_LT((re - expected.real()).norm(), 1e-12 * (1 + expected.norm()));
    }
}

TEST(Cholesky, RefusesIndefiniteMatricesAndTakesTheNextOfTheSamePattern) {
    SparseMatrix lower = random_symmetric(60, 3, 0.1).triangularView<Eigen::Lower>();
    const CholeskyPattern pattern(lower);
    EXPECT_FALSE(pattern.factorise(lower));
    for (int i = 0; i < 60; ++i) lower.coeffRef(i, i) += 20;
    EXPECT_TRUE(pattern.factorise(lower));
}

TEST(GroundedInverse, InvertsOnEachComponent) {
    const TriangleMesh mesh =
        reference::joined(reference::grid(6, 5, 1, 1, 0.2), reference::grid(3, 3, 2, 2, 0.2), Point(5, 0));
    const SparseMatrix L = cotangent_stiffness(mesh);
    const Eigen::VectorXi component = vertex_components(mesh);
    Eigen::VectorXcd r(mesh.V.rows());
    for (int v = 0; v < r.size(); ++v) r(v) = {std::sin(7.0 * v), std::cos(5.0 * v)};
    for (int c = 0; c < 2; ++c) {
        std::complex<double> sum = 0;
        double count = 0;
        for (int v = 0; v < r.size(); ++v) {
            if (component(v) == c) sum += r(v), ++count;
        }
        for (int v = 0; v < r.size(); ++v) {
            if (component(v) == c) r(v) -= sum / count;
        }
    }
    const Eigen::VectorXcd x = GroundedInverse(L, component) * r;
    EXPECT_LT((L * x - r).norm(), 1e-11 * r.norm());
}

TEST(ConstraintSpace, ProjectsAndStepsWithDependentRows) {
    ConstraintSpace::Rows C(4, 6);
    const std::vector<Eigen::Triplet<double>> entries{{0, 0, 1.0}, {0, 1, 2.0}, {1, 2, 1.0}, {2, 0, 2.0},
                                                      {2, 1, 4.0}, {3, 4, 1.0}, {3, 5, -1.0}};
    C.setFromTriplets(entries.begin(), entries.end());
    const ConstraintSpace space(C);
    Eigen::VectorXd x(6);
    x << 1, 2, 3, 4, 5, 6;
    Eigen::VectorXd inside = x;
    space.project(inside);
    EXPECT_LT((C * inside).norm(), 1e-14);
    // The nearest one: the difference is orthogonal to the null space.
    EXPECT_NEAR((x - inside).dot(inside), 0, 1e-12);
    EXPECT_EQ(inside(3), 4);

    Eigen::VectorXd d(4);
    d << 3, 7, 6, -1;  // row 2 is twice row 0, and so is its value
    const Eigen::VectorXd y = x + space.step_onto(x, d);
    EXPECT_LT((C * y - d).norm(), 1e-13);
}

TEST(ConstraintSpace, OfNoRowsChangesNothing) {
    const ConstraintSpace space(ConstraintSpace::Rows(0, 3));
    Eigen::VectorXd x = Eigen::Vector3d(1, 2, 3);
    space.project(x);
    EXPECT_EQ(x, Eigen::VectorXd(Eigen::Vector3d(1, 2, 3)));
    EXPECT_EQ(space.step_onto(x, Eigen::VectorXd()).norm(), 0);
}

}  // namespace
}  // namespace puppetwarp
