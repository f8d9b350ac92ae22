#pragma once

#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/rig/rig.h>

namespace puppetwarp {

//! The rig with every point handle and end of a bone that lies outside the mesh moved to the nearest place on it.
//! \param max_px  how far each may be moved, at least 0; with 0 nothing moves.
//! \throw InvalidInput  one lies farther outside (names it and says how far).
Rig snapped(const Rig& rig, const TriangleMesh& mesh, double max_px);

}  // namespace puppetwarp
