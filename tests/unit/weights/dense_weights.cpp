#include "dense_weights.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <stdexcept>

namespace puppetwarp {

namespace {

using Matrix = Eigen::MatrixXd;
using Array = Eigen::ArrayXXd;

class InteriorPoint {
public:
    InteriorPoint(const Matrix& Q, const Matrix& load, bool sum)
        : Q_(Q),
          load_(load),
          sum_(sum),
          W_(Array::Constant(load.rows(), load.cols(), sum ? 1.0 / static_cast<double>(load.cols()) : 0.5)),
          lower_(Array::Constant(load.rows(), load.cols(), Q.diagonal().mean())),
          upper_(lower_),
          lambda_(Eigen::VectorXd::Zero(load.rows())) {
        if (sum && load.cols() == 1) throw std::logic_error("nothing to solve");
    }

    Matrix run() {
        const double scale = Q_.diagonal().maxCoeff();
        for (int iteration = 0; iteration < 60; ++iteration) {
            const double gap =
                ((W_ * lower_).sum() + ((1 - W_) * upper_).sum()) / (2.0 * static_cast<double>(W_.size()));
            if (gap < 1e-17 * scale) break;
            step(0.05 * gap);
        }
        return W_.matrix();
    }

private:
    // Newton's method on Q W + load - lower + upper + lambda 1^T = 0, W lower = target, (1 - W) upper = target, W 1
    // = 1.
    void step(double target) {
        const Array H = lower_ / W_ + upper_ / (1 - W_);
        const Matrix residual = Q_ * W_.matrix() + load_ + lambda_.replicate(1, W_.cols());
        const Matrix r = -(residual.array() - target / W_ + target / (1 - W_)).matrix();
        std::vector<Eigen::LLT<Matrix>> factors;
        Matrix dW(W_.rows(), W_.cols());
        Matrix S = Matrix::Zero(W_.rows(), W_.rows());
        for (Eigen::Index j = 0; j < W_.cols(); ++j) {
            Matrix K = Q_;
            K.diagonal() += H.col(j).matrix();
            factors.emplace_back(K);
            dW.col(j) = factors.back().solve(r.col(j));
            if (sum_) S += factors.back().solve(Matrix::Identity(K.rows(), K.rows()));
        }
        Eigen::VectorXd dlambda = Eigen::VectorXd::Zero(W_.rows());
        if (sum_) {
            const Eigen::VectorXd missing = 1 - W_.rowwise().sum();
            dlambda = S.llt().solve(dW.rowwise().sum() - missing);
            for (Eigen::Index j = 0; j < W_.cols(); ++j)
                dW.col(j) -= factors[static_cast<std::size_t>(j)].solve(dlambda);
        }
        const Array d = dW.array();
        const Array d_lower = target / W_ - lower_ - lower_ / W_ * d;
        const Array d_upper = target / (1 - W_) - upper_ + upper_ / (1 - W_) * d;
        const double primal = std::min(reach(W_, d), reach(1 - W_, -d));
        const double dual = std::min(reach(lower_, d_lower), reach(upper_, d_upper));
        const double length = std::min(primal, dual);
        W_ += length * d;
        lower_ += length * d_lower;
        upper_ += length * d_upper;
        lambda_ += length * dlambda;
    }

    static double reach(const Array& x, const Array& d) {
        double longest = 1;
        for (Eigen::Index k = 0; k < x.size(); ++k) {
            if (d(k) < 0) longest = std::min(longest, -0.99 * x(k) / d(k));
        }
        return longest;
    }

    Matrix Q_, load_;
    bool sum_;
    Array W_, lower_, upper_;
    Eigen::VectorXd lambda_;
};

}  // namespace

Eigen::MatrixXd dense_weights(const DenseWeightProblem& problem) {
    const auto n = static_cast<int>(problem.Q.rows());
    Matrix W = Matrix::Zero(n, problem.values.cols());
    W(problem.vertices, Eigen::all) = problem.values;
    std::vector<int> free;
    for (int v = 0; v < n; ++v) {
        if (!std::binary_search(problem.vertices.begin(), problem.vertices.end(), v)) free.push_back(v);
    }
    if (free.empty()) return W;
    const Matrix load = (problem.Q * W)(free, Eigen::all).colwise() + problem.c(free);
    W(free, Eigen::all) = InteriorPoint(problem.Q(free, free), load, problem.rows_sum_to_one).run();
    return W;
}

}  // namespace puppetwarp
