#pragma once
// Private header.

#include <puppetwarp/base/point.h>
#include <puppetwarp/mesh/triangle_mesh.h>

#include <vector>

namespace puppetwarp {

//! A mesh that covers another and more.
struct ExtendedMesh {
    TriangleMesh mesh;
    std::vector<int> place;  //!< #V of the other: the index of each of its vertices here, or -1
};

//! A mesh of all that a mesh or a ring holds, whose edges run along the rings. It keeps the vertices of the mesh, and
//! so its density, but for those that crowd a ring, where they would force slivers; what a ring adds is coarser away
//! from the mesh. Within a ring the boundary and the holes of the mesh are no more. Where the boundary meets a ring, it
//! is followed to about an edge's length. \param rings  polygons that do not meet themselves or each other, of any
//! orientation. \param keep   vertices to keep even if they crowd a ring. \pre `require_sound(mesh, ...)`. \throw
//! InvalidInput  rings so narrow for their length that round-off makes triangles flat. Triangles are Delaunay but for
//! edges along rings and boundary; where the rings add them, of at least 20 degrees away from sharp corners (Shewchuk
//! 2002; CGAL 2D Mesh Generation).
ExtendedMesh extended_mesh(const TriangleMesh& mesh, const std::vector<Polyline>& rings, const std::vector<int>& keep);

}  // namespace puppetwarp
