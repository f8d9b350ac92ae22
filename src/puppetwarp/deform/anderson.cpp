#include <puppetwarp/deform/anderson.h>

#include <Eigen/QR>

namespace puppetwarp {

namespace {

constexpr std::size_t window = 8;
// A residual that grew to so many times the least one has left where the steps speak of.
constexpr double lost = 4;
constexpr double rank_threshold = 1e-10;

double real_product(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
    return a.dot(b).real();
}

}  // namespace

Eigen::VectorXcd AndersonMixing::next(const Eigen::VectorXcd& x, const Eigen::VectorXcd& g) {
    const Eigen::VectorXcd residual = g - x;
    const double length = residual.norm();
    const bool first = value_.size() == 0;
    if (!first) {
        value_steps_.push_back(g - value_);
        residual_steps_.push_back(residual - residual_);
    }
    if (first || length < least_) least_ = length;
    if (length > lost * least_) {
        value_steps_.clear();
        residual_steps_.clear();
        least_ = length;
    }
    if (value_steps_.size() > window) {
        value_steps_.pop_front();
        residual_steps_.pop_front();
    }
    value_ = g;
    residual_ = residual;

    const auto m = static_cast<Eigen::Index>(residual_steps_.size());
    if (m == 0) return g;
    Eigen::MatrixXd gram(m, m);
    Eigen::VectorXd b(m);
    for (Eigen::Index i = 0; i < m; ++i) {
        const Eigen::VectorXcd& step = residual_steps_[static_cast<std::size_t>(i)];
        for (Eigen::Index j = 0; j <= i; ++j) {
            gram(i, j) = gram(j, i) = real_product(step, residual_steps_[static_cast<std::size_t>(j)]);
        }
        b(i) = real_product(step, residual);
    }
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    solver.setThreshold(rank_threshold);
    solver.compute(gram);
    const Eigen::VectorXd weights = solver.solve(b);
    Eigen::VectorXcd mixed = g;
    for (Eigen::Index i = 0; i < m; ++i) mixed -= weights(i) * value_steps_[static_cast<std::size_t>(i)];
    return mixed;
}

}  // namespace puppetwarp
