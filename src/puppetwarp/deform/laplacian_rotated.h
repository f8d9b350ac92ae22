#pragma once
// Private header.

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/deform/held_quadratic.h>
#include <puppetwarp/deform/laplacian_operators.h>

namespace puppetwarp {

//! `laplacian-rotated`: positions whose uniform Laplacian is that of the rest pose, each vector turned as its
//! neighbourhood turned. Lipman et al. 2004 estimate the turns once, from an unturned solve; here solve and estimate
//! alternate until positions settle, beginning with the rigid motion that fits the handles best, so that rigid motions
//! of all handles are met exactly and nothing depends on the frame. A turn is the rotation that fits a vertex and three
//! rings around it best. All solves share one factor; the alternation is accelerated (Anderson 1965, Walker & Ni 2011),
//! which changes its speed alone.
//! Not a descent: the turns do not minimise the energy |K x - r delta|^2, so its history holds only the end, px^2.
//! An angle without scale leaves that free, a scale without angle the direction.
class RotatedLaplacianDeformer : public Deformer {
public:
    //! \param options  converged: a solve moves no vertex by more than `tolerance` times the bounding diagonal.
    RotatedLaplacianDeformer(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig);
    Deformation deform(const Pose& pose, const Eigen::MatrixX2d* start, Progress& progress) const override;

private:
    void solve(const HeldGoals& goals, const Eigen::VectorXcd& turn, Eigen::VectorXcd& x) const;
    Eigen::VectorXcd turned(const Eigen::VectorXcd& x, const Eigen::VectorXcd& otherwise) const;

    MethodOptions options_;
    TriangleMesh mesh_;
    Rig rig_;
    Eigen::VectorXcd rest_;
    double size_;
    Eigen::VectorXi component_;
    std::vector<std::vector<int>> neighbours_;
    Binding binding_;
    DifferentialEnergy energy_;
    HeldQuadratic quadratic_;
};

}  // namespace puppetwarp
