#pragma once
// Private header.

#include <Eigen/Core>
#include <Eigen/QR>

namespace puppetwarp {

//! [ means of answers   means of modes ]
//! [ of modes, adjoint  0              ] takes multipliers and shares of modes to means and pushes on modes; this
//! solves for the former. Means that depend on each other are met as far as they can be.
class MeanSystem {
public:
    //! \param means  #means x (#means + #modes): of the answers to loads on the means, then of the modes.
    explicit MeanSystem(const Eigen::MatrixXcd& means);

    //! What solves it, as a matrix: there are many right-hand sides.
    Eigen::MatrixXcd inverse() const;

private:
    Eigen::VectorXd scale_;
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXcd> solver_;
};

//! Combinations of the columns that are 0: an orthonormal basis, one a column.
Eigen::MatrixXcd null_space(const Eigen::MatrixXcd& columns);

}  // namespace puppetwarp
