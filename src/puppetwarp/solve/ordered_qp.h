#pragma once
// Private header: nothing of solve/ is installed.

#include <puppetwarp/solve/cholesky.h>
#include <puppetwarp/solve/quadratic_program.h>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <array>
#include <vector>

namespace puppetwarp {

//! x[high] - x[low] >= least. An index of -1 stands for 0: the other variable is bounded alone.
struct OrderConstraint {
    int low = -1;
    int high = -1;
    double least = 0;
};

struct OrderedQpSolution : QpReport {
    Eigen::VectorXd x;
};

//! min 1/2 x^T Q x + c^T x under order constraints, by a primal-dual interior point method with Mehrotra's (1992)
//! predictor and corrector: each iteration factorises Q + A^T D A once, D diagonal. A constraint between two variables
//! that Q couples brings no fill, so that the order of elimination is found once for all constraints and all c.
//! No BLAS, one thread. Immutable.
//! The KKT residual is the largest of |Qx + c - A^T z| / Q_vv, of what a constraint is violated by, and of the smaller
//! of multiplier / Q_vv and slack, one of which is 0 at the minimum. Their product, the usual measure, flatters: where
//! both vanish x is off by its root.
class OrderedQp {
public:
    //! \param Q  n x n, symmetric positive definite, both triangles, compressed.
    explicit OrderedQp(const Eigen::SparseMatrix<double>& Q);

    //! \param constraints  their pairs are coupled by Q.
    //! \param start        n, from which to begin; need not be feasible.
    //! \return none where Q is not positive definite.
    std::optional<OrderedQpSolution> solve(const Eigen::VectorXd& c, const std::vector<OrderConstraint>& constraints,
                                           const Eigen::VectorXd& start, const QpOptions& options) const;

private:
    friend class OrderedQpIteration;
    Eigen::SparseMatrix<double> Q_;
    Eigen::SparseMatrix<double> lower_;
    Eigen::VectorXd diagonal_;
    CholeskyPattern pattern_;
};

}  // namespace puppetwarp
