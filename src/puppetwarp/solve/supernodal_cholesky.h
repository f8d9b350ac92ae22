#pragma once
// Private header: nothing of solve/ is installed.

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <memory>
#include <optional>

namespace puppetwarp {

//! Numbers of one row lie together.
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

//! P A P^T = L L^T of a sparse symmetric positive definite A by supernodes: columns of L with the same rows form dense
//! blocks, several times as fast as CholeskyFactor where L has much fill (Ng & Peyton 1993; Chen, Davis, Hager &
//! Rajamanickam 2008). The order (approximate minimum degree) and the supernodes are CHOLMOD's, the numbers are worked
//! out here with Eigen's dense kernels, so that the bits do not depend on the machine's BLAS as CHOLMOD's own would.
//! One thread. Immutable.
class SupernodalCholesky {
public:
    //! \param lower  lower triangle of a symmetric matrix, compressed; entries above the diagonal are ignored.
    //! \return none when the matrix is not positive definite.   \throw MachineFault  out of memory.
    static std::optional<SupernodalCholesky> factorise(const Eigen::SparseMatrix<double>& lower);

    SupernodalCholesky(SupernodalCholesky&&) noexcept;
    SupernodalCholesky& operator=(SupernodalCholesky&&) noexcept;
    ~SupernodalCholesky();

    //! Replaces b by A^-1 b.
    void solve_in_place(Eigen::VectorXd& b) const;
    //! The same for several right-hand sides, one a column, ten of them in one pass; quicker where they are sparse.
    void solve_in_place(RowMatrix& B) const;

private:
    struct Factor;
    explicit SupernodalCholesky(std::unique_ptr<const Factor> factor);
    std::unique_ptr<const Factor> factor_;
};

}  // namespace puppetwarp
