#pragma once
// Private header: nothing of solve/ is installed.

#include <puppetwarp/solve/quadratic_program.h>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <optional>
#include <vector>

namespace puppetwarp {

//! #rows x #columns, one row's shares beside each other.
using Shares = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

//! min sum_j 1/2 w_j^T Q w_j over the columns w_j of W, W >= 0, rows of W sum to 1.
struct SimplexQp {
    const Eigen::SparseMatrix<double>& Q;  //!< n x n, symmetric, both triangles, compressed; diagonal above 0
    const std::vector<char>& given;        //!< n, whether a row of W is given
};

struct SimplexQpSolution : QpReport {
    Shares W;  //!< n x m, at least 0, rows sum to 1 to round-off, also where it did not converge
};

//! Primal-dual active set as for `solve_box_qp`, with the sum eliminated: in each row the largest share is the pivot, 1
//! less the others, and takes what they give (ALGORITHMS.md section 6). W <= 1 follows. Only pairs of row and column
//! that are not held at 0 are unknowns; they grow from each other: shares apart from them are released only when
//! nothing else changes. When a set comes back or half of the iterations are spent, projected Newton steps in the same
//! unknowns take over, which always descend (Bertsekas 1982, section on simplices). With mu_vj = (QW)_vj -
//! (QW)_v,pivot(v), the KKT residual is the largest |mu| / Q_vv of shares above 0, and max(-mu, 0) / Q_vv of those at
//! 0. \param start  n x m, rows of at least one number above 0: which shares are held at 0 at first. Given rows have
//! their
//!               values here.
//! \return none where Q is not positive definite on the unknowns.
std::optional<SimplexQpSolution> solve_simplex_qp(const SimplexQp& problem, const Shares& start,
                                                  const QpOptions& options);

//! The same with a start from anywhere: the KKT residual at W (rows on the simplex), as defined there.
double simplex_kkt_residual(const SimplexQp& problem, const Shares& W);

}  // namespace puppetwarp
