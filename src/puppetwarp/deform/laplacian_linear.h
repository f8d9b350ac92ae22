#pragma once
// Private header.

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/deform/held_quadratic.h>
#include <puppetwarp/deform/laplacian_operators.h>

namespace puppetwarp {

//! `laplacian` and `laplacian-similarity`: one least-squares solve for positions whose uniform Laplacian is that of the
//! rest pose (the same vectors, or these turned and scaled with their neighbourhoods), with every vertex's row and the
//! handles as exact constraints, where the paper has them as further rows.   Sorkine et al. 2004.
//! `laplacian` follows translations of all handles only. Of a point, an angle without scale means scale 1, a scale
//! without angle leaves the direction free; an affine map fixes f_z and f_zbar.
//! `laplacian-similarity` follows similarities of all handles; an angle without scale leaves that free. What one
//! point leaves free stays as it rests. In the plane similarities are exactly linear: nothing is linearised.
//! Stiffness weighs rows by the mean of the triangles at a vertex. Energy: of the rows, px^2.
class LinearLaplacianDeformer : public Deformer {
public:
    //! \param method  one of the two.
    LinearLaplacianDeformer(Method method, const TriangleMesh& mesh, const Rig& rig);
    Deformation deform(const Pose& pose, const Eigen::MatrixX2d* start, Progress& progress) const override;

private:
    bool similar() const { return method_ == Method::laplacian_similarity; }
    AffineUse affine() const { return similar() ? AffineUse::no : AffineUse::yes; }

    Method method_;
    TriangleMesh mesh_;
    Rig rig_;
    Eigen::VectorXcd rest_;
    Eigen::VectorXi component_;
    Binding binding_;
    DifferentialEnergy energy_;
    HeldQuadratic quadratic_;
};

}  // namespace puppetwarp
