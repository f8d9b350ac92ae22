#pragma once
// Private header.

#include <puppetwarp/solve/cholesky.h>

#include <vector>

namespace puppetwarp {

//! A linear G with L G r = r for every r that sums to 0 over each component of L: the inverse of L with one unknown of
//! each component held at 0. Symmetric. Immutable.
class GroundedInverse {
public:
    //! \param L          #V x #V, symmetric positive semi-definite, its null space the functions that are constant on
    //!                   each component.
    //! \param component  #V, 0-based numbers as `vertex_components` gives.
    GroundedInverse(const Eigen::SparseMatrix<double>& L, const Eigen::VectorXi& component);

    //! G r; 0 at the first vertex of each component.
    Eigen::VectorXcd operator*(const Eigen::VectorXcd& r) const;
    //! The same for several right-hand sides, one a column.
    Eigen::MatrixXd operator*(const Eigen::MatrixXd& R) const;

private:
    std::vector<int> free_;  // the vertices that are not grounded
    std::optional<CholeskyFactor> factor_;
};

}  // namespace puppetwarp
