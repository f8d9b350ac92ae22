#pragma once

#include <puppetwarp/mesh/outline.h>
#include <puppetwarp/mesh/triangle_mesh.h>

namespace puppetwarp {

inline constexpr int fewest_cage_corners = 3;
inline constexpr int most_cage_corners = 500;

//! A cage around a whole subject: a closed polygon of positive area, from its topmost corner on, that does not cross
//! itself and stays a hundredth of the subject's diagonal away from it (less in 1e-4). It follows the subject where
//! that saves area and corners allow, down to the gaps between limbs; several components are held by one cage, across
//! the shortest ways between them. Corners that tightness does not need divide the longest edges, so that these can be
//! bent.
//! The outline of the subject grown by the margin, whose corners are merged and moved (`CageShaper`, after Sander et
//! al. 2000); or its convex hull treated in the same way, where that comes out better or the other cannot do with so
//! few. Moving or scaling the subject moves and scales the cage.
//! \param outline  need not be sound: what is asked is that it has coordinates.
//! \param corners  `fewest_cage_corners` to `most_cage_corners`.
//! \throw InvalidInput  a number of corners out of range, an outline that is empty, without extent or not finite.
Polyline automatic_cage(const Outline& outline, int corners);

//! The same around all triangles of a mesh. \pre `require_sound(mesh, ...)`.
Polyline automatic_cage(const TriangleMesh& mesh, int corners);

}  // namespace puppetwarp
