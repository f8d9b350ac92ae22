#pragma once
// Private header.

#include <puppetwarp/rig/binding.h>

#include <Eigen/SparseCore>

#include <vector>

namespace puppetwarp {

//! Weights by vertex: #V x #columns, rows sum to 1.
using WeightRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

//! Linear blend skinning: x_v = sum_j w_vj T_j(z_v).   Magnenat-Thalmann et al. 1988.
//! The mean of rotations shrinks: by |1/2 + 1/2 e^(i theta)| midway between two that are theta apart, to nothing at 180
//! degrees. What all maps leave in place stays to the bit, also where rows miss 1 by round-off.
//! \param z     #V rest positions.   \param maps  one a column.
//! \return #V positions.
Eigen::VectorXcd linear_blend(const WeightRows& W, const Eigen::VectorXcd& z, const std::vector<AffineMap>& maps);

}  // namespace puppetwarp
