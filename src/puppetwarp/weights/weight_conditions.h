#pragma once
// Private header.

#include <puppetwarp/weights/weight_problem.h>

namespace puppetwarp {

//! Vertices this share of the diagonal from a cage's edge are on it: the edge was made of them.
inline constexpr double on_cage_edge = 1e-9;

//! \throw InvalidInput  the index of the vertex handle `id` is out of range.
void require_vertex(const TriangleMesh& mesh, const std::string& id, const VertexHandle& vertex);

//! How the handles of a rig hold the vertices of a mesh for the families that are solved on it.
//! - A point holds the corner nearest to it of the triangle that it lies in; a vertex handle its vertex; a region all
//!   inside.
//! - A bone holds, along itself, of each triangle that it crosses the corner nearest to it. Bones that meet (an end of
//!   one lies on the other, or a point lies on an end) ask for 1 and 0 at one place, where the energy of any function
//!   between diverges under refinement: within a small radius of such a joint, a share of the subject's size and never
//!   more than a quarter of the bone, bones hold nothing.
//! - Along the edges of a cage, corners share linearly.
//! - A component without any of these goes to the nearest handle.
//! \throw InvalidInput  see `compute_weights`.
WeightConditions weight_conditions(const TriangleMesh& mesh, const Rig& rig);

}  // namespace puppetwarp
