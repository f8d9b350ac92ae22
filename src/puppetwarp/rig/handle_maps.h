#pragma once
// Private header.

#include <puppetwarp/rig/binding.h>

namespace puppetwarp {

//! How each handle of a rig moves as a whole: `bone_maps` for bones; points and regions turn and grow about their place
//! or centroid, which goes to `to`; vertices are moved; cages, whose corners move one by one, get the identity.
//! \param V  #V x 2 rest positions that vertex handles index; empty: these get the identity too.
//! \pre require_sound(rig), require_sound(pose, rig).
//! \return one map a handle.
//! \throw InvalidInput  `bone_maps`.
std::vector<AffineMap> handle_maps(const Rig& rig, const Pose& pose, const Eigen::MatrixX2d& V = {});

}  // namespace puppetwarp
