#pragma once
// Private header.

#include <puppetwarp/mesh/triangle_mesh.h>

#include <vector>

namespace puppetwarp {

//! Length of the shortest way inside the mesh from each vertex to the nearest source, in pixels; infinite where there
//! is none. #V. Fast marching with straight fronts through triangles (Kimmel & Sethian 1998): exact for straight
//! fronts, of first order in the edges' length for round ones and behind corners, where it is too long. Deviation:
//! obtuse triangles are not split; a vertex that a front reaches through one out of turn gets the length along an edge.
//! \param sources  vertices of distance 0; both ends of an edge make the whole edge a source.
Eigen::VectorXd geodesic_distance(const TriangleMesh& mesh, const std::vector<int>& sources);

}  // namespace puppetwarp
