#pragma once
// Private header.

#include <puppetwarp/deform/energy.h>

#include <complex>
#include <memory>
#include <vector>

namespace puppetwarp {

//! A triangle and what its map needs: with edges d_k = x_k - x_0,
//! f_z = c_1 d_1 + c_2 d_2 and f_zbar = conj(c_1) d_1 + conj(c_2) d_2.
struct Element {
    int v[3];
    double weight;  // area times stiffness
    std::complex<double> c1;
    std::complex<double> c2;
};

//! \param stiffness  #F factors of each triangle's weight, or empty for 1.
std::vector<Element> elements_of(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness);

//! As rigid as possible by triangles (Liu et al. 2008): sum of area * 2 ((a - 1)^2 + b^2), a = |f_z|, b = |f_zbar|,
//! which is area * |D - R|^2 with the closest rotation R.
std::unique_ptr<Energy> make_element_arap(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness);

//! Symmetric Dirichlet (Smith & Schaefer 2015): sum of area * (|D|^2 + |D^-1|^2 - 4), infinite when a triangle folds
//! over. The 4 makes it 0 at rest.
std::unique_ptr<Energy> make_symmetric_dirichlet(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness);

}  // namespace puppetwarp
