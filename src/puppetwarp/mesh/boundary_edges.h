#pragma once
// Private header.

#include <puppetwarp/mesh/triangle_mesh.h>

#include <utility>
#include <vector>

namespace puppetwarp {

//! Edges of one triangle alone, from vertex to vertex as the triangle runs, sorted.
std::vector<std::pair<int, int>> boundary_edges(const TriangleMesh& mesh);

}  // namespace puppetwarp
