#pragma once
// Private header.

#include <puppetwarp/base/point.h>

#include <Eigen/Core>

namespace puppetwarp {

struct CauchyCoordinates {
    Eigen::MatrixXcd C;        //!< #P x #corners; rows sum to 1
    Eigen::Index outside = 0;  //!< how many places lie outside of the cage
};

//! Cauchy coordinates of places in a cage: z goes to sum_j C_j(z) v'_j, all written as complex numbers, a map that is
//! holomorphic inside, hence conformal. With v_j ordered to positive area, B_j = v_j - z, A_j = v_j - v_{j-1}:
//!     C_j = 1 / (2 pi i) [ B_{j+1} / A_{j+1} log(B_{j+1} / B_j) - B_{j-1} / A_j log(B_j / B_{j-1}) ].
//! The same map as 2D Green coordinates with their stretch factors.   Weber, Ben-Chen & Gotsman 2009; Lipman, Levin &
//! Cohen-Or 2008.
//! They do not interpolate: on the cage, where the formula is undefined, this returns the limit from inside. Outside,
//! where the integral would be 0 and a vertex would fall onto the origin, a place follows the cage: the nearest place
//! on it by its limit, and what is between them by the similarity that takes the nearest edge to its target; about a
//! corner the similarities of its two edges are blended by angle. This continues the map continuously and reproduces
//! similarities; it is not of the papers.
//! \param P     #P x 2 places.
//! \param cage  a polygon that does not cross itself, of either orientation.
CauchyCoordinates cauchy_coordinates(const Eigen::MatrixX2d& P, const Polyline& cage);

}  // namespace puppetwarp
