#include "reference/test_meshes.h"

#include <puppetwarp/mesh/operators.h>
#include <puppetwarp/solve/cholesky.h>
#include <puppetwarp/solve/grounded_inverse.h>
#include <puppetwarp/solve/paired_cholesky.h>
#include <puppetwarp/solve/supernodal_cholesky.h>

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

TEST(SupernodalCholesky, SolvesWhatADenseSolverSolves) {
    const auto expect_solved = [](const SparseMatrix& A) {
        const SparseMatrix lower = A.triangularView<Eigen::Lower>();
        const auto factor = SupernodalCholesky::factorise(lower);
        ASSERT_TRUE(factor);
        Eigen::VectorXd b(A.rows());
        for (Eigen::Index i = 0; i < b.size(); ++i) b(i) = std::sin(static_cast<double>(i) + 1);
        const Eigen::VectorXd expected = Eigen::MatrixXd(A).partialPivLu().solve(b);
        Eigen::VectorXd x = b;
        factor->solve_in_place(x);
        EXPECT_LT((x - expected).norm(), 1e-10 * (1 + expected.norm())) << A.rows();
    };
    for (const int n : {1, 2, 17, 120, 400}) expect_solved(random_symmetric(n, 5, 12));
    // With supernodes of many columns, and with components apart.
    const TriangleMesh mesh = reference::joined(reference::grid(20, 15, 20, 15), reference::blob(200, 14, 3), {300, 0});
    const SparseMatrix L = cotangent_stiffness(mesh);
    SparseMatrix Q = SparseMatrix(L * L) * L;
    for (Eigen::Index v = 0; v < Q.rows(); ++v) Q.coeffRef(v, v) += 1;
    Q.makeCompressed();
    expect_solved(Q);
}

TEST(SupernodalCholesky, SolvesSeveralRightHandSidesAtOnce) {
    for (const int columns : {1, 9, 10, 11, 23}) {
        const SparseMatrix A = random_symmetric(150, 4, 30);
        const auto factor = SupernodalCholesky::factorise(A.triangularView<Eigen::Lower>());
        ASSERT_TRUE(factor.has_value());
        RowMatrix B = RowMatrix::Zero(150, columns);
        for (int c = 0; c < columns; ++c) B((37 * c + 5) % 150, c) = 1 + c;  // sparse
        B.col(columns / 2).setLinSpaced(-1, 1);                              // and not
        RowMatrix X = B;
        factor->solve_in_place(X);
        const Eigen::MatrixXd expected = Eigen::MatrixXd(A).llt().solve(Eigen::MatrixXd(B));
        EXPECT_LT((X - expected).norm(), 1e-12 * expected.norm()) << columns;
    }
}

TEST(SupernodalCholesky, RefusesIndefiniteMatrices) {
    EXPECT_FALSE(SupernodalCholesky::factorise(random_symmetric(60, 3, 0.1).triangularView<Eigen::Lower>()));
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

// Blocks of a mesh's stiffness with coupled parts: random, symmetric, made definite by a heavy diagonal.
Eigen::SparseMatrix<double> paired_matrix(const TriangleMesh& mesh, double diagonal) {
    const SparseMatrix L = cotangent_stiffness(mesh);
    std::mt19937 random(3);
    std::vector<Eigen::Triplet<double>> entries;
    for (int column = 0; column < L.outerSize(); ++column) {
        for (SparseMatrix::InnerIterator it(L, column); it; ++it) {
            const auto row = static_cast<int>(it.row());
            if (row < column) continue;
            for (int k = 0; k < 4; ++k) {
                const int i = 2 * row + k % 2, j = 2 * column + k / 2;
                if (i < j) continue;
                const double value = static_cast<double>(random()) / 4294967296.0 - 0.5;
                entries.emplace_back(i, j, i == j ? diagonal + value : value);
            }
        }
    }
    Eigen::SparseMatrix<double> lower(2 * L.rows(), 2 * L.rows());
    lower.setFromTriplets(entries.begin(), entries.end());
    return lower;
}

TEST(PairedCholesky, SolvesToSinglePrecision) {
    const Eigen::SparseMatrix<double> lower = paired_matrix(reference::grid(12, 9, 12, 9, 0.2), 8);
    const auto factor = PairedCholeskyPattern(lower).factorise(lower);
    ASSERT_TRUE(factor);
    Eigen::VectorXd b(lower.rows());
    for (Eigen::Index k = 0; k < b.size(); ++k) b(k) = std::sin(3.0 * static_cast<double>(k));
    Eigen::VectorXcd x(b.size() / 2);
    for (Eigen::Index v = 0; v < x.size(); ++v) x(v) = {b(2 * v), b(2 * v + 1)};
    Eigen::VectorXcd again = x, other = Eigen::VectorXcd::Ones(x.size()), alone = other;
    factor->solve_in_place(x);
    factor->solve_in_place(again, other);
    factor->solve_in_place(alone);
    EXPECT_EQ(again, x);
    EXPECT_EQ(other, alone);
    const Eigen::VectorXd expected = Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>().llt().solve(b);
    for (Eigen::Index v = 0; v < x.size(); ++v) {
        EXPECT_NEAR(x(v).real(), expected(2 * v), 1e-6 * expected.norm());
        EXPECT_NEAR(x(v).imag(), expected(2 * v + 1), 1e-6 * expected.norm());
    }
}

TEST(PairedCholesky, KnowsWhatIsNotPositiveDefinite) {
    const Eigen::SparseMatrix<double> lower = paired_matrix(reference::grid(4, 4, 4, 4), 0.1);
    EXPECT_FALSE(PairedCholeskyPattern(lower).factorise(lower));
}

}  // namespace
}  // namespace puppetwarp
