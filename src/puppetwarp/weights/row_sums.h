#pragma once
// Private header.

#include <puppetwarp/mesh/triangle_mesh.h>

namespace puppetwarp {

//! Divides rows of weights by their sums. A vertex that no handle reaches takes part of what is around it: harmonic
//! weights there, given by the vertices that are reached.
//! \param W  #V x #columns, at least 0; some row of each component above 0.
//! \throw InvalidInput  the mesh's triangles are too bad to factorise.
void divide_by_row_sums(const TriangleMesh& mesh, Eigen::MatrixXd& W);

}  // namespace puppetwarp
