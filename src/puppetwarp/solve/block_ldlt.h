#pragma once
// Private header: nothing of solve/ is installed.

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <memory>
#include <optional>
#include <vector>

namespace puppetwarp {

namespace detail {
class BlockFactor;
}

//! A symmetric matrix of n x n blocks, each `size` x `size`, most of them 0.
struct BlockMatrix {
    int size = 1;                         //!< of a block, 1 to 4
    Eigen::SparseMatrix<double> pattern;  //!< n x n lower triangle, compressed: where blocks are; its values are unused
    std::vector<double> blocks;           //!< of the pattern's entries in their order, each column by column
};

//! P A P^T = L D L^T of a sparse symmetric indefinite A, with D of blocks. There is no pivoting between blocks, only
//! within: for the mixed systems of FieldInverse, whose blocks stay as well conditioned as the pivots of the Laplacian
//! that they contain. The order is approximate minimum degree on the blocks' pattern (Amestoy et al. 1996), the
//! factorisation goes row by row (Davis 2005). No BLAS, one thread: the bits depend on nothing but the input.
//! Immutable, safe to share between threads.
class BlockLdlt {
public:
    BlockLdlt(BlockLdlt&&) noexcept;
    BlockLdlt& operator=(BlockLdlt&&) noexcept;
    ~BlockLdlt();

    //! \return none when a diagonal block is singular or a number overflows.
    static std::optional<BlockLdlt> factorise(const BlockMatrix& A);

    //! A^-1 B. \param B  (n * size) x #right-hand sides; row v * size + i is component i of block row v.
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;

private:
    explicit BlockLdlt(std::unique_ptr<const detail::BlockFactor> factor);
    std::unique_ptr<const detail::BlockFactor> factor_;
};

}  // namespace puppetwarp
