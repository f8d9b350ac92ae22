#pragma once
// Private header.

#include <puppetwarp/deform/rigid_blend.h>

#include <complex>
#include <vector>

namespace puppetwarp {

//! z -> e^log z + shift, log = log scale + i angle, whole turns counted.
struct Similarity {
    std::complex<double> log;
    std::complex<double> shift;
};

//! At each vertex the weighted Karcher mean of similarities in their universal covering group, applied to z: the one
//! from which the logarithms to all others sum to 0. Rotations alone are SE(2) (Buss & Fillmore 2001, Alexa 2002); the
//! closed form needs no iteration, since angles and log scales commute:
//!   log = sum_j w_j log_j,   shift = sum_j w_j g_j shift_j / sum_j w_j g_j,   g_j = g(log_j - log),  g(l) = l / (e^l -
//!   1)
//! Bi-invariant: moving all motions before or after by one similarity moves the mean by it. g has a pole where an angle
//! is a whole turn from the mean; long before, where motions are a whole turn apart from each other, the sum of w_j g_j
//! passes 0 and no mean is near: this sum is the steadiness.
//! \param W     rows sum to 1.   \param z     #V.   \param motions  one a column.
BlendedPositions similarity_mean(const WeightRows& W, const Eigen::VectorXcd& z,
                                 const std::vector<Similarity>& motions);

}  // namespace puppetwarp
