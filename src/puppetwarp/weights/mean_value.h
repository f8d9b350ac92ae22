#pragma once
// Private header.

#include <puppetwarp/base/point.h>

#include <Eigen/Core>

namespace puppetwarp {

//! Mean value coordinates of places in a cage:
//!     w_j = (tan(alpha_{j-1} / 2) + tan(alpha_j / 2)) / |v_j - z|, divided by their sum,
//! alpha_j the signed angle from v_j to v_{j+1} seen from z. They reproduce linear functions, are linear along the
//! cage's edges, and are defined in the whole plane, outside of the cage too; negative where a concave cage is seen
//! from behind.     Floater 2003; Hormann & Floater 2006.
//! \param P     #P x 2 places.
//! \param cage  a polygon that does not cross itself, of either orientation.
//! \return #P x #corners; rows sum to 1.
Eigen::MatrixXd mean_value_coordinates(const Eigen::MatrixX2d& P, const Polyline& cage);

}  // namespace puppetwarp
