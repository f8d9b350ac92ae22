#pragma once
// Private header.

#include <puppetwarp/deform/held_quadratic.h>
#include <puppetwarp/mesh/triangle_mesh.h>

namespace puppetwarp {

//! The least-squares energy of a differential representation, |B x - target|^2.
struct DifferentialEnergy {
    QuadraticForm::Matrix B;  //!< #V x #V
    Eigen::VectorXcd target;  //!< #V

    double operator()(const Eigen::VectorXcd& x) const;
    //! B^H (target - B x): half the energy's descent.
    Eigen::VectorXcd load(const Eigen::VectorXcd& x) const;
};

//! Neighbours of each vertex by an edge, ascending.
std::vector<std::vector<int>> neighbours_of(const TriangleMesh& mesh);

//! Uniform graph Laplacian: (K x)_i = x_i - mean of x over the neighbours of i. #V x #V, not symmetric; a vertex
//! of no triangle has a row of zeros.   Sorkine et al. 2004.
Eigen::SparseMatrix<double> graph_laplacian(const std::vector<std::vector<int>>& neighbours);

//! sum_i s_i |(K x)_i - delta_i|^2 with the delta_i of rest. s_i: the mean stiffness of the triangles at i, 1 where
//! none is set.   Sorkine et al. 2004, equation 5, without the handles' term.
DifferentialEnergy laplacian_energy(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness);

//! sum_i s_i |(K x)_i - t_i(x) delta_i|^2, t_i(x) the similarity (complex factor) that fits the rest positions of i and
//! its neighbours to x best.   Sorkine et al. 2004, section 3.1: in the plane exactly linear in x.
DifferentialEnergy similarity_laplacian_energy(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness);

}  // namespace puppetwarp
