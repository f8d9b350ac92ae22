#pragma once

#include <Eigen/Core>

#include <vector>

namespace puppetwarp {

//! min sum_j 1/2 w_j^T Q w_j + c^T w_j over columns w_j of W with rows `vertices` given, 0 <= W <= 1.
struct DenseWeightProblem {
    Eigen::MatrixXd Q;
    Eigen::VectorXd c;          //!< per unit of every weight
    std::vector<int> vertices;  //!< ascending
    Eigen::MatrixXd values;     //!< #vertices x #columns
    bool rows_sum_to_one = false;
};

//! By a primal-dual interior point method with dense matrices (Nocedal & Wright 2006, chapter 16.6), slow, with nothing
//! of the library.
Eigen::MatrixXd dense_weights(const DenseWeightProblem& problem);

}  // namespace puppetwarp
