#pragma once

#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/rig/rig.h>

namespace puppetwarp {

//! The rig with every point handle that lies outside the mesh moved to the nearest place on it.
//! \param max_px  how far a point may be moved, at least 0; with 0 nothing moves.
//! \throw InvalidInput  a point lies farther outside (names it and says how far).
Rig snapped(const Rig& rig, const TriangleMesh& mesh, double max_px);

}  // namespace puppetwarp
