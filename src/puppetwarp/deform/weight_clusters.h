#pragma once
// Private header.

#include <Eigen/Core>

namespace puppetwarp {

//! Groups rows that are alike: k-means (Lloyd 1982) with squared distances, first centres by farthest-point traversal
//! from the row that is farthest from the mean (Gonzalez 1985). Deterministic; ties go to the lower index.
//! \param rows     #rows x #columns.
//! \param weights  #rows, what each row counts in the mean of its group; at least 0.
//! \param most     number of groups, at least 1; fewer come out where rows coincide.
//! \return #rows, the group of each, numbered without gaps from 0.
Eigen::VectorXi weight_clusters(const Eigen::MatrixXd& rows, const Eigen::VectorXd& weights, int most);

}  // namespace puppetwarp
