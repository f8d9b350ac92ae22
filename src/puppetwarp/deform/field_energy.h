#pragma once
// Private header.

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/mesh/operators.h>

namespace puppetwarp {

//! A quadratic energy of displacements u:
//!     weight * u^H L (M^-1 L)^(order - 1) u  +  first_order * u^H K u,
//! L and K cotangent stiffness matrices, M lumped mass, every row of L in use. Its null space are the functions that
//! are constant on each component. With every row, what is natural at a free border is that the normal derivative of u,
//! and of each (M^-1 L)^j u but the last, vanishes (Stein et al. 2018): affine maps are no minimisers unless all
//! vertices within order - 1 edges of the border are held.
struct FieldEnergy {
    int order = 1;  //!< 1 to 4
    double weight = 1;
    SparseMatrix L;          //!< #V x #V
    Eigen::VectorXd M;       //!< #V areas; 0 at a vertex of no triangle
    double first_order = 0;  //!< above 0 only with order 2
    SparseMatrix K;          //!< #V x #V; empty: L

    //! The energy of a displacement. #V
    double operator()(const Eigen::VectorXcd& u) const;
};

}  // namespace puppetwarp
