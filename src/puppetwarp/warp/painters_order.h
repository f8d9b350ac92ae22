#pragma once

#include <puppetwarp/mesh/triangle_mesh.h>

namespace puppetwarp {

//! Which triangles are painted after which others, so that the nearer ones cover the farther ones.
//!
//! By the mean depth of a triangle's corners, ties by its index: it depends on depths alone, never on positions, so
//! that nothing changes sides while a picture moves. \param depth  #V, larger is nearer; empty: all alike. \return #F
//! indices of triangles, the farthest first. \throw InvalidInput  depths that are not finite or not one for each
//! vertex.
Eigen::VectorXi painters_order(const TriangleMesh& mesh, const Eigen::VectorXd& depth);

}  // namespace puppetwarp
