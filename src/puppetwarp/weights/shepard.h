#pragma once
// Private header.

#include <puppetwarp/weights/weights.h>

namespace puppetwarp {

//! w_j = d_j^-2 / sum_k d_k^-2, d_j the distance in the plane to a point, a vertex, a bone or a region (Shepard 1968).
//! Of a cage each edge is such a handle, shared by its corners by distance along it, so that weights are linear on the
//! edges. Not aware of the shape and not local: every handle acts everywhere. Handles at distance 0 share alike.
//! #V x #columns.
Eigen::MatrixXd shepard_weights(const TriangleMesh& mesh, const Rig& rig);

}  // namespace puppetwarp
