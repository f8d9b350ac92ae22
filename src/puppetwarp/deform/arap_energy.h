#pragma once
// Private header.

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/mesh/operators.h>

#include <complex>
#include <vector>

namespace puppetwarp {

//! The three as-rigid-as-possible energies as one: cells of weighted edges that share a rotation,
//! E(x) = sum over cells c of min over |r| = 1 of sum over edges e of c of w_e |x_e - r rest_e|^2,
//! positions as complex numbers. `elements`: a triangle's edges, w = cot / 2, which is area * |D - R|^2 (Liu et al.
//! 2008). `spokes`: the edges at a vertex, w = the sum of both cot / 2 (Sorkine & Alexa 2007). `spokes_and_rims`: all
//! edges of the triangles at a vertex, w = cot / 2 for each triangle (Chao et al. 2010), so that a triangle counts
//! three times. E is 0 at rest and does not change under rigid motions. Immutable.
class ArapCells {
public:
    struct Edge {
        int i;
        int j;
        double w;
        std::complex<double> rest;  // of j - i
    };

    //! \param stiffness  #F factors of each triangle's weights, or empty for 1.
    ArapCells(const TriangleMesh& mesh, ArapEnergy energy, const Eigen::VectorXd& stiffness);

    int count() const { return static_cast<int>(first_edge_.size()) - 1; }
    //! Vertices of a cell, ascending.
    const int* vertices_begin(int cell) const {
        return cell_vertices_.data() + first_vertex_[static_cast<std::size_t>(cell)];
    }
    const int* vertices_end(int cell) const {
        return cell_vertices_.data() + first_vertex_[static_cast<std::size_t>(cell) + 1];
    }

    double energy(const Eigen::VectorXcd& x) const;
    //! \param gradient  #V; dE/dRe x + i dE/dIm x.   \return the energy.
    double gradient(const Eigen::VectorXcd& x, Eigen::VectorXcd& gradient) const;

    //! Sum over all cells of x^H K x: the energy without its rotations. #V x #V, positive semi-definite.
    const SparseMatrix& K() const { return K_; }
    //! The rest of the second derivative: for each cell a weight, at least 0, and one complex number a vertex of the
    //! cell, in the order of `vertices_begin`, so that the Hessian is 2 K - sum over cells of weight t t^T with t =
    //! (Re, Im) of those numbers, over the unknowns (Re x, Im x).
    struct Twist {
        double weight;
        const std::complex<double>* t;
    };
    //! \param clamped  limits each weight to its value at rest, which makes the Hessian positive semi-definite.
    //! \param t        room for the numbers of this cell.
    Twist twist(int cell, const Eigen::VectorXcd& x, bool clamped, std::vector<std::complex<double>>& t) const;

private:
    std::complex<double> correlation(int cell, const Eigen::VectorXcd& x) const;

    int vertices_;
    std::vector<Edge> edges_;
    std::vector<int> first_edge_;
    std::vector<int> cell_vertices_;
    std::vector<int> first_vertex_;
    std::vector<std::complex<double>> functional_;  // S_c: coefficients beside cell_vertices_
    std::vector<double> rest_correlation_;          // |S_c| at rest
    SparseMatrix K_;
};

}  // namespace puppetwarp
