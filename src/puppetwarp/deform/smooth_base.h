#pragma once
// Private header.

#include <puppetwarp/mesh/triangle_mesh.h>

#include <Eigen/Core>

namespace puppetwarp {

//! What a mesh's shape has of detail: the positions less those of its smooth base. #V
//! Along the outline the base b of the positions p is the least of  integral of |b - p|^2 + length^4 |b''|^2 ds:  waves
//! of the outline are taken out as far as they are shorter than 2 pi length, straight pieces stay, and a circle of
//! radius R keeps 1 / (1 + (length / R)^4) of it, where the area-diffusing filters of surfaces would shrink the outline
//! to nothing. `length_px` is limited to a third of the radius of the circle as long as each loop, which so keeps 98 %
//! of its size at least. Inside, detail is the harmonic function of that on the outline. (Every operator that is exact
//! for linear functions finds the inside of a plane mesh perfectly smooth: what can be smoothed is the outline.)
//! Where more than two edges of the outline meet there is no detail.
//! \throw InvalidInput  the mesh's triangles are too bad to compute with.
Eigen::VectorXcd detail_over_smooth_base(const TriangleMesh& mesh, double length_px);

}  // namespace puppetwarp
