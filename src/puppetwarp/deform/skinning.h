#pragma once
// Private header.

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/deform/rigid_blend.h>
#include <puppetwarp/deform/skinning_weights.h>

namespace puppetwarp {

//! `lbs`, `dual-complex`, `intrinsic`: at each vertex the mean of how the handles move, by its weights; closed forms of
//! the weights and the motions alone, the mesh has no say. A point with a free angle does not turn. Parts of the mesh
//! that no handle holds follow the nearest, as their weights say. Energy: 0, none is minimised.
//! `lbs` takes any affine maps (`linear_blend`); the others blend shears first, then similarities
//! (`dual_complex_blend`, `similarity_mean`), and refuse maps that mirror or flatten.
class SkinningDeformer : public Deformer {
public:
    //! \param method   one of the three.
    //! \param weights  of this mesh and rig, rows sum to 1; what they warn of, each deformation does.
    SkinningDeformer(Method method, const TriangleMesh& mesh, const Rig& rig, const Weights& weights);
    Deformation deform(const Pose& pose, const Eigen::MatrixX2d* start, Progress& progress) const override;

private:
    BlendedPositions blended(const std::vector<ColumnMotion>& motions) const;

    Method method_;
    Eigen::MatrixX2d V_;
    Eigen::VectorXcd rest_;
    Rig rig_;
    SkinningWeights weights_;
};

}  // namespace puppetwarp
