#pragma once
// Private header.

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/deform/skinning_weights.h>
#include <puppetwarp/deform/subspace_arap.h>

namespace puppetwarp {

//! `fast`: linear blend skinning in which points find out themselves how they turn, scale and shear: the least
//! as-rigid-as-possible energy that blending can reach, in time that does not grow with the mesh but for the last
//! blend.   Jacobson, Baran, Kavan & Sorkine 2012.
//! Bones, regions, corners of cages and points with an angle or an affine map move as posed; of the other points and
//! of vertices the place does, a scale without an angle leaves the direction free, `turn_rad` says from which turn to
//! begin. Starts from the rest pose brought to the handles by the best rigid motion, or with the rotations of the given
//! start.
//! Deviations: the small system is minimised by Newton's method where the paper alternates, with the rotations
//! eliminated (`minimise`): the same minima, in fewer steps. Rotations are shared by triangles, not vertices. The
//! paper's extra weight functions, which let a part bend between handles, are left out: they cost every frame as much
//! as further handles do, and a point set there says the same and can be seen; `arap` bends everywhere.
//! Energy: the sum over triangles of area |D - R|^2 with a rotation R for each group of them, at least `arap`'s.
class FastSkinningDeformer : public Deformer {
public:
    //! \param weights  of this mesh and rig, rows sum to 1; what they warn of, each deformation does.
    //! \throw InvalidInput  complex weights.
    FastSkinningDeformer(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig,
                         const Weights& weights);
    Deformation deform(const Pose& pose, const Eigen::MatrixX2d* start, Progress& progress) const override;

private:
    struct Frame;
    Frame frame_of(const std::vector<ColumnMotion>& motions, const Pose& pose) const;
    std::vector<SubspaceUnknown> unknowns(const Pose& pose) const;

    MethodOptions options_;
    Eigen::MatrixX2d V_;
    Eigen::VectorXcd rest_;
    Rig rig_;
    SkinningWeights weights_;
    Eigen::VectorXcd centres_;
    SubspaceArap arap_;
};

}  // namespace puppetwarp
