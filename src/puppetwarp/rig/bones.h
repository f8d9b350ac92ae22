#pragma once
// Private header.

#include <puppetwarp/rig/binding.h>

namespace puppetwarp {

//! How a bone moves as a whole.
struct BoneMotion {
    AffineMap map;
    double angle_rad = 0;  //!< of map.alpha, whole turns counted along the chain
};

//! Forward kinematics: how each bone moves as a whole, `reach` resolved. The identity for handles that are no bones.
//! A bone that a pose does not name follows its parent. `from` and `to` give its ends (one that is not given follows
//! the parent) and make it a similarity, without a scale of its own where its length is fixed; `rotate_deg` and `scale`
//! act about its own `from`, before the parent's map; `affine` stands alone. Angles add up along the tree, scales
//! multiply. A bone's angle is its parent's plus its own: as the pose says it, else to less than half a turn.
//! \pre require_sound(rig), require_sound(pose, rig).
//! \return one motion a handle of the rig.
//! \throw InvalidInput  both ends of a bone are sent to one place; `with_reaches`.
std::vector<BoneMotion> bone_motions(const Rig& rig, const Pose& pose);

//! Their maps.
std::vector<AffineMap> bone_maps(const Rig& rig, const Pose& pose);

//! The map of HandlePose::affine.
AffineMap affine_map(const std::array<double, 6>& entries);

//! outer(inner(z)).
AffineMap composed(const AffineMap& outer, const AffineMap& inner);

//! Turns by alpha, an angle and a scale, about `centre`, which goes to `to`.
AffineMap similarity_about(std::complex<double> centre, std::complex<double> alpha, std::complex<double> to);

}  // namespace puppetwarp
