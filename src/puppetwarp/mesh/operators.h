#pragma once
// Private header: sparse matrices do not appear in the installed ones.

#include <puppetwarp/mesh/triangle_mesh.h>

#include <Eigen/SparseCore>

namespace puppetwarp {

using SparseMatrix = Eigen::SparseMatrix<double>;

//! Cotangent stiffness L, #V x #V, symmetric positive semi-definite: x^T L x is the Dirichlet energy of x.
//! Rows sum to 0. Orientation of the triangles does not matter.
//! \param stiffness  #F factors of each triangle's contribution, or empty for 1.   Pinkall & Polthier 1993.
SparseMatrix cotangent_stiffness(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness = {});

//! Lumped mass M, #V areas, sum = the mesh's area: mixed Voronoi everywhere.   Meyer et al. 2003.
Eigen::VectorXd lumped_mass(const TriangleMesh& mesh);

//! Gradients of the hat functions as one complex number a corner: g = gx + i gy with
//! grad(phi_k) on triangle t = G(t, k). #F x 3, 1/px. For a function with corner values u the gradient is sum_k u_k
//! G(t, k).
Eigen::MatrixX3cd hat_gradients(const TriangleMesh& mesh);

}  // namespace puppetwarp
