#pragma once
// Private header.

#include <puppetwarp/rig/binding.h>

namespace puppetwarp {

//! Forward kinematics: how each bone moves as a whole. The identity for handles that are no bones.
//! A bone that a pose does not name follows its parent. `from` and `to` give its ends (one that is not given follows
//! the parent) and make it a similarity; `rotate_deg` and `scale` act about its own `from`, before the parent's map;
//! `affine` stands alone. Angles add up along the tree, scales multiply.
//! \pre require_sound(rig), require_sound(pose, rig).
//! \return one map a handle of the rig.
//! \throw InvalidInput  both ends of a bone are sent to one place.
std::vector<AffineMap> bone_maps(const Rig& rig, const Pose& pose);

//! The map of HandlePose::affine.
AffineMap affine_map(const std::array<double, 6>& entries);

//! outer(inner(z)).
AffineMap composed(const AffineMap& outer, const AffineMap& inner);

//! Turns by alpha, an angle and a scale, about `centre`, which goes to `to`.
AffineMap similarity_about(std::complex<double> centre, std::complex<double> alpha, std::complex<double> to);

}  // namespace puppetwarp
