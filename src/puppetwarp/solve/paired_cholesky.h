#pragma once
// Private header: nothing of solve/ is installed.

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace puppetwarp {

namespace detail {
struct CholmodFactor;
}

//! A P^T = L L^T of a symmetric positive definite A whose unknowns come in pairs, the two parts of a position, kept by
//! 2 x 2 blocks in single precision: for metrics of iterations that correct themselves. A solve moves half of the
//! memory of one in double precision, which is what bounds it. Immutable, safe to share between threads.
class PairedCholeskyFactor {
public:
    //! Replaces b (one complex number a pair) by A^-1 b, to about six digits.
    void solve_in_place(Eigen::VectorXcd& b) const;
    //! The same for two right-hand sides in one pass over the factor.
    void solve_in_place(Eigen::VectorXcd& b, Eigen::VectorXcd& c) const;

private:
    friend class PairedCholeskyPattern;
    template <std::size_t count>
    void substitute(const std::array<Eigen::VectorXcd*, count>& sides) const;

    struct Block {
        float at[4];  // column by column
    };
    std::vector<int> order_;
    std::vector<std::size_t> first_;  // of each pair of columns, into rows_ and blocks_
    std::vector<int> rows_;
    std::vector<Block> blocks_;
    std::vector<double> diagonal_;  // 1 / L00, L10, 1 / L11 of each pair
};

//! The order of elimination (approximate minimum degree on pairs) and the fill of all matrices of one pattern.
//! Immutable, safe to share between threads.
class PairedCholeskyPattern {
public:
    //! \param lower  lower triangle of a symmetric matrix of 2 n unknowns, compressed; the pattern is one of whole
    //!               2 x 2 blocks, but for the upper corner of those on the diagonal.
    //! \throw MachineFault  out of memory.
    explicit PairedCholeskyPattern(const Eigen::SparseMatrix<double>& lower);
    PairedCholeskyPattern(PairedCholeskyPattern&&) noexcept;
    PairedCholeskyPattern& operator=(PairedCholeskyPattern&&) noexcept;
    ~PairedCholeskyPattern();

    //! \param lower  a matrix with the pattern given at construction.
    //! \return none when the matrix is not positive definite.   \throw MachineFault  out of memory.
    std::optional<PairedCholeskyFactor> factorise(const Eigen::SparseMatrix<double>& lower) const;

private:
    std::unique_ptr<detail::CholmodFactor> symbolic_;
};

}  // namespace puppetwarp
