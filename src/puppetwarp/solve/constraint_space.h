#pragma once
// Private header.

#include <Eigen/Core>
#include <Eigen/QR>
#include <Eigen/SparseCore>

namespace puppetwarp {

//! The affine space C x = d and its null space, for a few constraints on many unknowns. Rows that depend on each other
//! are accepted as long as they do not contradict each other. Immutable.
class ConstraintSpace {
public:
    using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

    //! \param C  #rows x #unknowns; rows are best of similar length.
    explicit ConstraintSpace(Rows C);

    const Rows& C() const { return C_; }
    //! The nearest vector to x (Euclidean) with C x = 0.
    void project(Eigen::VectorXd& x) const;
    //! The shortest step p that brings C (x + p) as near to d as it can be.
    Eigen::VectorXd step_onto(const Eigen::VectorXd& x, const Eigen::VectorXd& d) const;

private:
    Rows C_;
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> gram_;  // of C C^T
};

}  // namespace puppetwarp
