#pragma once
// Private header: nothing of solve/ is installed.

#include <puppetwarp/solve/quadratic_program.h>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <optional>

namespace puppetwarp {

//! min 1/2 x^T Q x + c^T x over lower <= x <= upper.
struct BoxQp {
    const Eigen::SparseMatrix<double>& Q;  //!< n x n, symmetric, both triangles, compressed; diagonal above 0
    const Eigen::VectorXd& c;              //!< n
    const Eigen::VectorXd& lower;          //!< n; -infinity: none
    const Eigen::VectorXd& upper;          //!< n, at least `lower`; equal to it where x is given
};

struct BoxQpSolution : QpReport {
    Eigen::VectorXd x;  //!< within the bounds, also where it did not converge
};

//! Primal-dual active set (Bergounioux, Ito & Kunisch 1999; Hintermueller, Ito & Kunisch 2002): the variables taken for
//! free are solved for by sparse Cholesky, then each variable changes sides by the sign of what it violates, until none
//! does. There is no proof that this ends where Q is no M-matrix, and the biharmonic is none: when a set comes back, or
//! half of the iterations are spent, projected Newton steps along the projection arc take over, which always descend
//! (Bertsekas 1982).
//! The KKT residual is the largest |Qx + c| / Q_vv of what is between its bounds, and of what is at one, of the part
//! that would pull it inside.
//! \param start  which variables are at their bounds at first: those where start is not strictly inside.
//! \return none where Q is not positive definite on free variables.
std::optional<BoxQpSolution> solve_box_qp(const BoxQp& problem, const Eigen::VectorXd& start, const QpOptions& options);

}  // namespace puppetwarp
