#pragma once
// Private header.

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/deform/held_quadratic.h>

namespace puppetwarp {

//! `multiresolution`: a smooth base without the outline's detail is deformed by a biharmonic displacement, and the
//! detail is put back turned as the base turned: the direction of the mean f_z of the base's map over three rings of
//! triangles around each vertex.   Kobbelt et al. 1998, Botsch & Kobbelt 2004; the base is that of
//! `detail_over_smooth_base`, its length as large as a disc by default. The displacement is on top of the rigid motion
//! that fits the handles best, so that rigid motions of all handles are met exactly and nothing depends on the frame.
//! Handles are constraints of the result, detail and all, where the paper has them of the base: what the detail turned
//! takes away from them goes into the base's displacement until that settles. An angle without scale means scale 1.
//! Energy: of the base's displacement u, u^H L M^-1 L u, without unit.
class MultiresolutionDeformer : public Deformer {
public:
    //! \param options  converged: the last round moved no vertex by more than `tolerance` times the bounding diagonal.
    MultiresolutionDeformer(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig);
    Deformation deform(const Pose& pose, const Eigen::MatrixX2d* start, Progress& progress) const override;

private:
    Eigen::VectorXcd ring_maps(const Eigen::VectorXcd& moved) const;

    MethodOptions options_;
    TriangleMesh mesh_;
    Rig rig_;
    Eigen::VectorXcd rest_;
    double size_;
    Eigen::VectorXi component_;
    Eigen::VectorXcd detail_;
    Eigen::VectorXcd base_;
    Eigen::VectorXcd ring_areas_;  // ring_maps of the base itself
    Binding binding_;
    QuadraticForm::Matrix B_;
    HeldQuadratic quadratic_;
};

}  // namespace puppetwarp
