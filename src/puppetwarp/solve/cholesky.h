#pragma once
// Private header: nothing of solve/ is installed.

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <memory>
#include <optional>

namespace puppetwarp {

namespace detail {
struct CholmodFactor;
}

//! A P^T = L L^T of a sparse symmetric positive definite A. Immutable, safe to share between threads.
//! Simplicial, so that no BLAS is called and the bits do not depend on the machine's.
class CholeskyFactor {
public:
    CholeskyFactor(CholeskyFactor&&) noexcept;
    CholeskyFactor& operator=(CholeskyFactor&&) noexcept;
    ~CholeskyFactor();

    int size() const;
    //! Replaces b by A^-1 b.
    void solve_in_place(Eigen::VectorXd& b) const;
    //! The same for a complex right-hand side; A is real, so both parts go through the factor in one pass.
    void solve_in_place(Eigen::VectorXcd& b) const;
    //! The same for several right-hand sides, one a column, three or four of them in one pass.
    void solve_in_place(Eigen::MatrixXd& B) const;

private:
    friend class CholeskyPattern;
    explicit CholeskyFactor(std::unique_ptr<detail::CholmodFactor> factor);
    std::unique_ptr<detail::CholmodFactor> factor_;
};

//! The order of elimination (approximate minimum degree) and the fill of all matrices of one pattern. Immutable, safe
//! to share between threads.
class CholeskyPattern {
public:
    //! \param lower  lower triangle of a symmetric matrix, compressed; entries above the diagonal are ignored.
    //! \throw MachineFault  out of memory.
    explicit CholeskyPattern(const Eigen::SparseMatrix<double>& lower);
    CholeskyPattern(CholeskyPattern&&) noexcept;
    CholeskyPattern& operator=(CholeskyPattern&&) noexcept;
    ~CholeskyPattern();

    //! \param lower  a matrix with the pattern given at construction.
    //! \return none when the matrix is not positive definite.   \throw MachineFault  out of memory.
    std::optional<CholeskyFactor> factorise(const Eigen::SparseMatrix<double>& lower) const;

private:
    std::unique_ptr<detail::CholmodFactor> symbolic_;
};

}  // namespace puppetwarp
