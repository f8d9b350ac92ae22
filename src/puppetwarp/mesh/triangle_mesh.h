#pragma once

#include <Eigen/Core>

namespace puppetwarp {

//! Triangles over image space.
struct TriangleMesh {
    Eigen::MatrixX2d V;  //!< #V x 2 rest positions, image pixels, y down
    Eigen::MatrixX3i F;  //!< #F x 3 vertex indices; `triangulate` gives positive area in image space
};

//! Signed double areas of the triangles of F with corners V. #F
Eigen::VectorXd double_areas(const Eigen::MatrixX2d& V, const Eigen::MatrixX3i& F);

//! Length of the diagonal of the bounding box of the points V (#V x 2). 0 for no points.
double bounding_diagonal(const Eigen::MatrixX2d& V);

//! Which connected component each vertex belongs to, 0-based, numbered by the lowest vertex index. #V
//! A vertex of no triangle is a component of its own.
Eigen::VectorXi vertex_components(const TriangleMesh& mesh);

//! Checks that a mesh from a file can be worked with.
//! \throw InvalidInput  no triangles, an index out of range, a coordinate that is not finite, a triangle of no area
//!        (names the first), triangles of both orientations, two triangles on one side of an edge.
void require_sound(const TriangleMesh& mesh, const char* subject);

}  // namespace puppetwarp
