#pragma once
// Private header.

#include <puppetwarp/mesh/triangle_mesh.h>

#include <vector>

namespace puppetwarp {

//! Length of the shortest way inside the mesh from each vertex to the nearest source, in pixels; infinite where there
//! is none. #V. Fast marching with straight fronts through triangles (Kimmel & Sethian 1998): exact where the front is
//! straight, else off by about the length of an edge times the turn of the front within a triangle, never too short
//! by more than the front's curvature within one. Obtuse triangles are not split: a vertex that a front reaches
//! through one out of turn takes the value along an edge, which is too long.
//! \param sources  vertices of distance 0; both ends of an edge make the whole edge a source.
Eigen::VectorXd geodesic_distance(const TriangleMesh& mesh, const std::vector<int>& sources);

}  // namespace puppetwarp
