#pragma once
// Private header.

#include <puppetwarp/deform/rigid_blend.h>

namespace puppetwarp {

//! Blends motions as dual complex numbers, the plane's dual quaternions: with rotations e^(i theta_j) and translations
//! t_j, p_j = e^(i theta_j / 2) and q_j = t_j conj(p_j) / 2, the sums P = sum w_j p_j and Q = sum w_j q_j over |P| move
//! z to p^2 z + 2 p q.   Matsuda et al. 2016; Kavan et al. 2008 for dual quaternions. Left- and right-invariant, does
//! not shrink; a joint bulges a little. The signs of p_j follow the whole turns of the angles, for the whole mesh
//! alike, where dual quaternions choose them by vertex, which tears. Not rigid parts come first, as in Kavan et al.'s
//! two phases: shears, then scales, log-linearly (`similarity_mean`), both about the columns' centres. The steadiness
//! is |P|. \param W  rows sum to 1.   \param z  #V.   \param motions  one a column.
BlendedPositions dual_complex_blend(const WeightRows& W, const Eigen::VectorXcd& z,
                                    const std::vector<SplitMotion>& motions);

}  // namespace puppetwarp
