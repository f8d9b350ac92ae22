#include <puppetwarp/solve/block_ldlt.h>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <random>

namespace puppetwarp {
namespace {

double uniform(std::mt19937& random) {
    return static_cast<double>(random()) / 4294967296.0 - 0.5;
}

// A random pattern; blocks as of mixed systems: the diagonal's antidiagonal is heavy, of either sign.
BlockMatrix random_blocks(int n, int size, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::vector<Eigen::Triplet<double>> entries;
    for (int v = 0; v < n; ++v) entries.emplace_back(v, v, 1.0);
    for (int k = 0; k < 2 * n; ++k) {
        const auto a = static_cast<int>(random() % static_cast<std::uint32_t>(n));
        const auto b = static_cast<int>(random() % static_cast<std::uint32_t>(n));
        if (a != b) entries.emplace_back(std::max(a, b), std::min(a, b), 1.0);
    }
    BlockMatrix A;
    A.size = size;
    A.pattern.resize(n, n);
    A.pattern.setFromTriplets(entries.begin(), entries.end());
    for (int column = 0; column < n; ++column) {
        for (Eigen::SparseMatrix<double>::InnerIterator it(A.pattern, column); it; ++it) {
            Eigen::MatrixXd block(size, size);
            for (int i = 0; i < size; ++i) {
                for (int j = 0; j < size; ++j) block(i, j) = uniform(random);
            }
            if (it.row() == column) {
                block = (block + block.transpose()).eval();
                for (int i = 0; i < size; ++i) block(i, size - 1 - i) += 12;
            }
            A.blocks.insert(A.blocks.end(), block.data(), block.data() + block.size());
        }
    }
    return A;
}

Eigen::MatrixXd dense(const BlockMatrix& A) {
    const Eigen::Index k = A.size;
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(k * A.pattern.rows(), k * A.pattern.rows());
    const double* next = A.blocks.data();
    for (int column = 0; column < A.pattern.cols(); ++column) {
        for (Eigen::SparseMatrix<double>::InnerIterator it(A.pattern, column); it; ++it, next += k * k) {
            const Eigen::Map<const Eigen::MatrixXd> block(next, k, k);
            result.block(it.row() * k, column * k, k, k) = block;
            result.block(column * k, it.row() * k, k, k) = block.transpose();
        }
    }
    return result;
}

TEST(BlockLdlt, SolvesWhatADenseSolverSolves) {
    for (const int size : {1, 2, 3, 4}) {
        for (const int n : {1, 2, 40}) {
            const BlockMatrix A = random_blocks(n, size, 7);
            const auto factor = BlockLdlt::factorise(A);
            ASSERT_TRUE(factor);
            for (const int columns : {1, 2, 3, 4, 7}) {
                Eigen::MatrixXd B(n * size, columns);
                for (Eigen::Index i = 0; i < B.size(); ++i) B(i) = std::sin(static_cast<double>(i) + 1);
                const Eigen::MatrixXd expected = dense(A).fullPivLu().solve(B);
                EXPECT_LT((factor->solve(B) - expected).norm(), 1e-12 * expected.norm());
            }
        }
    }
}

TEST(BlockLdlt, RefusesASingularBlock) {
    BlockMatrix A = random_blocks(5, 2, 1);
    std::fill(A.blocks.begin(), A.blocks.end(), 0.0);
    EXPECT_FALSE(BlockLdlt::factorise(A));
}

}  // namespace
}  // namespace puppetwarp
