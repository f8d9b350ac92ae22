#pragma once
// Private header.

#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/rig/rig.h>

namespace puppetwarp {

//! Checks what weights of any kind ask of the cages of a rig.
//! \pre require_sound(mesh, ...), require_sound(rig).
//! \throw InvalidInput  a cage with a corner too far away, with two corners in one place, without area, that crosses or
//!        touches itself (says where) or another cage, or with no vertex of the mesh in it.
void require_sound_cages(const TriangleMesh& mesh, const Rig& rig);

//! \throw InvalidInput  the rig has no cage.
void require_a_cage(const Rig& rig);

}  // namespace puppetwarp
