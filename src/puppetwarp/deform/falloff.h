#pragma once
// Private header.

#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/rig/binding.h>

namespace puppetwarp {

//! How much each vertex follows each region that has a falloff: 1 inside the region and 0 where any other handle holds
//! (the vertices of other regions and of vertex handles, and of the discs of points and bones). #V x #such regions, in
//! the order of the rig. 0 where the region cannot be reached inside the mesh.
//!  - `Falloff::harmonic`: Lap s = 0 in between, natural at the border. The weights of regions alone sum to 1.
//!  - `Falloff::geodesic`: s_j = d_j^-2 / sum_i d_i^-2 over the distances inside the mesh (`geodesic_distance`) to each
//!    region with a falloff and to all else that is held, taken together: smooth, flat at both ends, the classic
//!    S-curve between two regions; sums to 1 where regions are alone.
//! \param stiffness  #F factors of the harmonic weights' Dirichlet energy, or empty.
Eigen::MatrixXd falloff_weights(const TriangleMesh& mesh, const Rig& rig, const Binding& binding,
                                const Eigen::VectorXd& stiffness);

//! Whether a handle is a region with a falloff.
bool has_falloff(const Handle& handle);

}  // namespace puppetwarp
