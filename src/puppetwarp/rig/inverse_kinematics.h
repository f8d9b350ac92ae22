#pragma once

#include <puppetwarp/rig/rig.h>

#include <string>
#include <vector>

namespace puppetwarp {

//! How a chain of bones comes to a target.
struct Reached {
    Pose pose;               //!< the given one with a `rotate_rad` for each bone of the chain
    double distance_px = 0;  //!< how far from the target the chain's end stayed; 0 to round-off where it can reach it
};

//! Inverse kinematics: bends a chain so that the end (`to`) of its last bone comes to a target.
//! One bone turns towards the target; two bend by the law of cosines, to the side to which they are bent already; more
//! by FABRIK (Aristidou & Lasenby 2011) from where the pose has them, finished in closed form. Lengths are kept.
//! Where the target is too far the chain is straight towards it, where it is too near it is folded; a target on the
//! chain's own start keeps its direction.
//! \param pose   where the chain is at first; its own `reach` keys are not looked at.
//! \param bone   id of the chain's last bone.
//! \param chain  how many bones bend, counted upwards from this one, at least 1; fewer where there are no more parents.
//! \pre require_sound(rig), require_sound(pose, rig).
//! \throw InvalidInput  `bone` is no bone; a bone of the chain has a `to` or `affine` of its own in the pose, or
//!        `from`, but for the first.
Reached reach(const Rig& rig, const Pose& pose, const std::string& bone, const Point& target, int chain = 2);

//! The pose with the `reach` of each of its bones, in the order of the rig, made into rotations.
//! \throw InvalidInput  as `reach`; two chains share a bone.
Pose with_reaches(const Rig& rig, const Pose& pose);

//! What a person should know of the reaches of a pose: each target that its chain does not come to, a sentence each.
//! \throw InvalidInput  as `with_reaches`.
std::vector<std::string> reach_warnings(const Rig& rig, const Pose& pose);

}  // namespace puppetwarp
