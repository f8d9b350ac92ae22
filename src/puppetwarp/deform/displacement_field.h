#pragma once
// Private header.

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/deform/field_responses.h>
#include <puppetwarp/deform/held_field.h>

#include <functional>
#include <memory>

namespace puppetwarp {

//! The displacement of least FieldEnergy that meets the handles: what `polyharmonic` and `thin_shell` share.
//!  - Points move the mean of their disc; bones the means of the discs along them; regions and vertices are met
//!  exactly.
//!  - A point's angle, with scale 1 unless one is given, fixes the mean f_z of its disc: the angle alone would let a
//!    point shrink by the cosine of the angle, since the field does not know turns. A scale alone fixes |mean f_z|, at
//!    the direction that costs least. An affine map fixes mean f_z and mean f_zbar.
//!  - A region with a falloff moves the mesh by its map times its weight (`falloff_weights`); the field of least energy
//!    is of what then remains at the other handles, and 0 in such regions. Moving all handles alike moves all alike,
//!    unless there are such regions and others beside.
//!  - The energies resist turns and affine maps, see FieldEnergy.
class DisplacementField final : public Deformer {
public:
    //! \param energy  of a mesh and its triangles' stiffness (#F, or empty).
    using EnergyOf = std::function<FieldEnergy(const TriangleMesh&, const Eigen::VectorXd&)>;
    DisplacementField(Method method, const EnergyOf& energy, const TriangleMesh& mesh, const Rig& rig);

    Deformation deform(const Pose& pose, const Eigen::MatrixX2d* start, Progress& progress) const override;
    //! Shares the factor, and the responses of all holds that stay, when stiffness and all that is held vertex by
    //! vertex are the same; weights of falloffs are computed anew. Else null.
    std::unique_ptr<Deformer> with_rig(const Rig& rig) const override;

private:
    // What depends on the mesh, the stiffness and the held vertices alone.
    struct Prepared;

    DisplacementField(std::shared_ptr<const Prepared> prepared, const Rig& rig, const DisplacementField* known);
    Eigen::VectorXcd falloff_displacement(const Targets& targets) const;
    std::complex<double> common_move(const Targets& targets) const;

    std::shared_ptr<const Prepared> prepared_;
    Rig rig_;
    Binding binding_;
    std::vector<int> held_handles_;  // that hold vertices, ascending
    std::vector<int> falloff_handles_;
    Eigen::MatrixXd falloff_;  // #V x #falloff_handles_
    FieldResponses responses_;
};

}  // namespace puppetwarp
