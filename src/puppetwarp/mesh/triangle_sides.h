#pragma once
// Private header.

#include <puppetwarp/mesh/triangle_mesh.h>

#include <utility>
#include <vector>

namespace puppetwarp {

//! Which side of which triangle lies against each: 3 u + m for side m of triangle u, or -1 at the boundary. Side k runs
//! from corner k to the next. \return #F * 3, of side k of triangle t at 3 t + k.
//! \param vertices  how many there are.
//! \pre triangles of one orientation, none twice.
std::vector<int> opposite_sides(const Eigen::MatrixX3i& F, Eigen::Index vertices);

//! Edges of one triangle alone, from vertex to vertex as the triangle runs, in the order of triangles and sides.
std::vector<std::pair<int, int>> boundary_edges(const TriangleMesh& mesh);

//! The triangles of a mesh with inner edges flipped until each is Delaunay between its two triangles, but for
//! round-off: the constrained Delaunay triangulation of what they cover.     Lawson 1977.
//! \param opposite  `opposite_sides` of F; becomes that of the result.
Eigen::MatrixX3i with_delaunay_edges(const Eigen::MatrixX2d& V, Eigen::MatrixX3i F, std::vector<int>& opposite);

}  // namespace puppetwarp
