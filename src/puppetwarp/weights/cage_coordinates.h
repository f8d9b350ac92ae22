#pragma once
// Private header.

#include <puppetwarp/weights/weights.h>

namespace puppetwarp {

//! Whether a kind is a formula of the corners of one cage.
bool is_closed_form(WeightKind kind);

//! Weights of `mean_value`, `green` or `cauchy`: columns, W, W_imaginary and warnings are set.
//! \throw InvalidInput  the rig is not one cage and nothing else; the cage, see `require_sound_cages`.
Weights cage_coordinates(const TriangleMesh& mesh, const Rig& rig, WeightKind kind);

}  // namespace puppetwarp
