#pragma once
// Private header.

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/deform/energy.h>

#include <complex>
#include <vector>

namespace puppetwarp {

//! The as-rigid-as-possible energies by vertices: cells of weighted edges that share a rotation,
//! E(x) = sum over cells c of min over |r| = 1 of sum over edges e of c of w_e |x_e - r rest_e|^2,
//! positions as complex numbers. `spokes`: the edges at a vertex, w = the sum of both cot / 2 (Sorkine & Alexa 2007).
//! `spokes_and_rims`: all edges of the triangles at a vertex, w = cot / 2 for each triangle (Chao et al. 2010), so that
//! a triangle counts three times. With the weights w of a triangle's own edges, `elements` would be one more;
//! ElementArap has it in a quicker form.
class ArapCells : public Energy {
public:
    struct Edge {
        int i;
        int j;
        double w;
        std::complex<double> rest;  // of j - i
    };

    //! \param energy     spokes or spokes_and_rims.
    //! \param stiffness  #F factors of each triangle's weights, or empty for 1.
    ArapCells(const TriangleMesh& mesh, ArapEnergy energy, const Eigen::VectorXd& stiffness);

    double value(const Eigen::VectorXcd& x) const override;
    double gradient(const Eigen::VectorXcd& x, Eigen::VectorXcd& g) const override;
    const SparseMatrix& constant_hessian() const override { return twice_K_; }
    int cells() const override { return static_cast<int>(first_edge_.size()) - 1; }
    std::span<const int> vertices(int cell) const override;
    //! -(2 / |S_c|) t t^T, t the derivative of the angle of S_c; clamped, |S_c| is at least what it is at rest.
    void cell_hessian(int cell, const Eigen::VectorXcd& x, HessianKind kind, double* lower) const override;

private:
    std::complex<double> correlation(int cell, const Eigen::VectorXcd& x) const;

    std::vector<Edge> edges_;
    std::vector<int> first_edge_;
    std::vector<int> cell_vertices_;
    std::vector<int> first_vertex_;
    std::vector<std::complex<double>> functional_;  // S_c: coefficients beside cell_vertices_
    std::vector<double> rest_correlation_;          // |S_c| at rest
    SparseMatrix twice_K_;                          // of the energy without its rotations
};

}  // namespace puppetwarp
