#include <puppetwarp/solve/constraint_space.h>

#include <utility>

namespace puppetwarp {

namespace {

// Below this share of the largest pivot a row of C C^T counts as a combination of others.
constexpr double rank_threshold = 1e-13;

}  // namespace

ConstraintSpace::ConstraintSpace(Rows C) : C_(std::move(C)) {
    if (C_.rows() == 0) return;
    gram_.setThreshold(rank_threshold);
    gram_.compute(Eigen::MatrixXd(C_ * C_.transpose()));
}

void ConstraintSpace::project(Eigen::VectorXd& x) const {
    if (C_.rows() == 0) return;
    // Twice: what round-off leaves after the first time is taken away by the second.
    for (int pass = 0; pass < 2; ++pass) x -= C_.transpose() * gram_.solve(C_ * x);
}

Eigen::VectorXd ConstraintSpace::step_onto(const Eigen::VectorXd& x, const Eigen::VectorXd& d) const {
    if (C_.rows() == 0) return Eigen::VectorXd::Zero(x.size());
    return C_.transpose() * gram_.solve(d - C_ * x);
}

}  // namespace puppetwarp
