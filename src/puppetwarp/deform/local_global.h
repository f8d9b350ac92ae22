#pragma once

#include <puppetwarp/deform/deformer.h>

#include <memory>

namespace puppetwarp {

//! As-rigid-as-possible deformation one step at a time: the alternation of local and global steps of Sorkine & Alexa
//! 2007 (Liu et al. 2008, Chao et al. 2010 for the other energies), for teaching and tests. `arap` finds the same
//! minima in far fewer steps. The energy is the sum over cells (`ArapEnergy`) of min over rotations r of sum over edges
//! w |x_e - r p_e|^2, px^2, with cotangent weights, times the rig's stiffness. Handles are exact linear constraints of
//! the global step. A point's angle without scale leaves that free. Parts without a handle stay. Immutable, safe to
//! share between threads.
class ArapLocalGlobal {
public:
    //! Factors the constant matrix of the global step.
    //! \throw InvalidInput  as `make_deformer`.
    ArapLocalGlobal(const TriangleMesh& mesh, const Rig& rig, ArapEnergy energy);
    ArapLocalGlobal(ArapLocalGlobal&&) noexcept;
    ArapLocalGlobal& operator=(ArapLocalGlobal&&) noexcept;
    ~ArapLocalGlobal();

    //! Fits the rotations to V, then moves V to the minimum of the energy with these rotations that meets the pose.
    //! \param V  #V x 2 positions, finite.
    //! \return the energy at the new V, each cell with its best rotation. From the second step of one pose on never
    //!         above the one before; a scale without angle must have settled on its direction first.
    //! \throw InvalidInput  the pose does not fit the rig, or asks for what cannot be met; V does not fit the mesh.
    double step(const Pose& pose, Eigen::MatrixX2d& V) const;

    //! The energy at V, each cell with its best rotation.
    double energy(const Eigen::MatrixX2d& V) const;

private:
    struct Parts;
    std::unique_ptr<const Parts> parts_;
};

}  // namespace puppetwarp
