#pragma once
// Private header.

#include <puppetwarp/deform/energy.h>

#include <memory>

namespace puppetwarp {

//! As rigid as possible by triangles plus a bending term, l^2 sum over inner vertices of |(L x)_i|^2 / M_i.
//! In the plane the rest positions have no Laplacian, so that the term is 0 at rest and under rigid (and all affine)
//! motions; it keeps point loads from making spikes at any resolution. Vertices on the border are left out: their
//! rows of L hold the normal derivative.   ALGORITHMS.md section 4; not from a paper.
class SmoothArapEnergy : public Energy {
public:
    //! \param bending_length_px  l, above 0.
    SmoothArapEnergy(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness, double bending_length_px);

    double value(const Eigen::VectorXcd& x) const override;
    double gradient(const Eigen::VectorXcd& x, Eigen::VectorXcd& g) const override;
    const SparseMatrix& constant_hessian() const override { return constant_; }
    int cells() const override { return arap_->cells(); }
    std::span<const int> vertices(int cell) const override { return arap_->vertices(cell); }
    void cell_hessian(int cell, const Eigen::VectorXcd& x, HessianKind kind, double* lower) const override {
        arap_->cell_hessian(cell, x, kind, lower);
    }

    //! The Hessian's bending part alone, #V x #V.
    const SparseMatrix& bending_hessian() const { return bending_; }

private:
    Eigen::VectorXcd curvature(const Eigen::VectorXcd& x) const;

    std::unique_ptr<Energy> arap_;
    SparseMatrix scaled_;  // rows of L of inner vertices times l / sqrt(M): the term is |scaled x|^2
    SparseMatrix bending_;
    SparseMatrix constant_;
};

}  // namespace puppetwarp
