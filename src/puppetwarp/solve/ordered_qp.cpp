#include <puppetwarp/solve/ordered_qp.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>

namespace puppetwarp {

namespace {

// Slacks and multipliers at the start, in the units of x and of Q's mean diagonal times x.
constexpr double first_slack = 1e-2;
constexpr double first_multiplier = 1e-3;
// How near to the boundary a step may come.
constexpr double step_share = 0.995;
// A constraint's share of the system, multiplier over slack, in units of Q's mean diagonal: beyond this, what Q says of
// the variables that it ties together would drown in round-off.
constexpr double stiffest = 1e12;

// Where a constraint's terms stand among the values of the lower triangle; -1: nowhere.
struct Places {
    std::ptrdiff_t low = -1;
    std::ptrdiff_t high = -1;
    std::ptrdiff_t cross = -1;
};

std::ptrdiff_t place_of(const Eigen::SparseMatrix<double>& lower, int a, int b) {
    const int row = std::max(a, b), column = std::min(a, b);
    const int* first = lower.innerIndexPtr() + lower.outerIndexPtr()[column];
    const int* last = lower.innerIndexPtr() + lower.outerIndexPtr()[column + 1];
    const int* found = std::lower_bound(first, last, row);
    assert(found != last && *found == row);
    return found - lower.innerIndexPtr();
}

}  // namespace

// One solve: x, slacks s = A x - b and multipliers z.
class OrderedQpIteration {
public:
    OrderedQpIteration(const OrderedQp& qp, const Eigen::VectorXd& c, const std::vector<OrderConstraint>& constraints,
                       const Eigen::VectorXd& start)
        : qp_(qp), c_(c), constraints_(constraints), system_(qp.lower_), unit_(qp.diagonal_.mean()), x_(start) {
        const auto count = static_cast<Eigen::Index>(constraints.size());
        for (const OrderConstraint& each : constraints) {
            Places places;
            if (each.low >= 0) places.low = place_of(system_, each.low, each.low);
            if (each.high >= 0) places.high = place_of(system_, each.high, each.high);
            if (each.low >= 0 && each.high >= 0) places.cross = place_of(system_, each.low, each.high);
            places_.push_back(places);
        }
        s_ = gaps(x_).cwiseMax(first_slack);
        z_ = Eigen::VectorXd::Constant(count, first_multiplier * unit_);
        evaluate();
    }

    double kkt_residual() const { return residual_; }
    const Eigen::VectorXd& x() const { return x_; }

    // \return whether the system could be factorised.
    bool step() {
        const auto count = static_cast<double>(constraints_.size());
        const Eigen::VectorXd D = z_.cwiseQuotient(s_);
        const std::optional<CholeskyFactor> factor = factorise(D);
        if (!factor) return false;
        const double mu = constraints_.empty() ? 0 : s_.dot(z_) / count;
        const Direction predictor = direction(*factor, D, s_.cwiseProduct(z_));
        const double reach_s = std::min(1.0, longest(s_, predictor.s));
        const double reach_z = std::min(1.0, longest(z_, predictor.z));
        const double after =
            constraints_.empty() ? 0 : (s_ + reach_s * predictor.s).dot(z_ + reach_z * predictor.z) / count;
        const double sigma = mu > 0 ? std::pow(after / mu, 3) : 0;
        const Eigen::VectorXd wanted =
            (s_.cwiseProduct(z_) + predictor.s.cwiseProduct(predictor.z)).array() - sigma * mu;
        const Direction corrector = direction(*factor, D, wanted);
        // One length for both: Q couples x and z.
        const double length = step_share * std::min(longest(s_, corrector.s), longest(z_, corrector.z));
        x_ += length * corrector.x;
        s_ += length * corrector.s;
        z_ += length * corrector.z;
        s_ = s_.cwiseMax(z_ / (stiffest * unit_));
        evaluate();
        return true;
    }

private:
    struct Direction {
        Eigen::VectorXd x, s, z;
    };

    // A x - b.
    Eigen::VectorXd gaps(const Eigen::VectorXd& x) const {
        Eigen::VectorXd gaps = differences(x);
        for (std::size_t i = 0; i < constraints_.size(); ++i) {
            gaps(static_cast<Eigen::Index>(i)) -= constraints_[i].least;
        }
        return gaps;
    }
    // A x.
    Eigen::VectorXd differences(const Eigen::VectorXd& x) const {
        Eigen::VectorXd result(static_cast<Eigen::Index>(constraints_.size()));
        for (std::size_t i = 0; i < constraints_.size(); ++i) {
            const OrderConstraint& each = constraints_[i];
            result(static_cast<Eigen::Index>(i)) =
                (each.high >= 0 ? x(each.high) : 0) - (each.low >= 0 ? x(each.low) : 0);
        }
        return result;
    }
    // A^T y.
    Eigen::VectorXd pulls(const Eigen::VectorXd& y) const {
        Eigen::VectorXd result = Eigen::VectorXd::Zero(x_.size());
        for (std::size_t i = 0; i < constraints_.size(); ++i) {
            const double value = y(static_cast<Eigen::Index>(i));
            if (constraints_[i].high >= 0) result(constraints_[i].high) += value;
            if (constraints_[i].low >= 0) result(constraints_[i].low) -= value;
        }
        return result;
    }

    void evaluate() {
        dual_ = qp_.Q_ * x_ + c_ - pulls(z_);
        const Eigen::VectorXd gap = gaps(x_);
        primal_ = gap - s_;
        residual_ = dual_.cwiseQuotient(qp_.diagonal_).cwiseAbs().maxCoeff();
        for (std::size_t i = 0; i < constraints_.size(); ++i) {
            const auto at = static_cast<Eigen::Index>(i);
            const OrderConstraint& each = constraints_[i];
            const double stiff = qp_.diagonal_(each.low >= 0 ? each.low : each.high);
            residual_ = std::max({residual_, -gap(at), std::min(z_(at) / stiff, std::abs(gap(at)))});
        }
    }

    std::optional<CholeskyFactor> factorise(const Eigen::VectorXd& D) {
        std::copy_n(qp_.lower_.valuePtr(), qp_.lower_.nonZeros(), system_.valuePtr());
        double* values = system_.valuePtr();
        for (std::size_t i = 0; i < places_.size(); ++i) {
            const double d = D(static_cast<Eigen::Index>(i));
            if (places_[i].low >= 0) values[places_[i].low] += d;
            if (places_[i].high >= 0) values[places_[i].high] += d;
            if (places_[i].cross >= 0) values[places_[i].cross] -= d;
        }
        return qp_.pattern_.factorise(system_);
    }

    // Towards s z = s z - `excess`, with A x - b = s and the gradient met by the multipliers.
    Direction direction(const CholeskyFactor& factor, const Eigen::VectorXd& D, const Eigen::VectorXd& excess) const {
        Direction to;
        to.x = -dual_ - pulls(excess.cwiseQuotient(s_) + D.cwiseProduct(primal_));
        factor.solve_in_place(to.x);
        to.s = differences(to.x) + primal_;
        to.z = -(excess + z_.cwiseProduct(to.s)).cwiseQuotient(s_);
        return to;
    }

    // The largest share of a step that keeps all above or at 0, at most what a whole step may have.
    static double longest(const Eigen::VectorXd& from, const Eigen::VectorXd& step) {
        double share = 1 / step_share;
        for (Eigen::Index i = 0; i < from.size(); ++i) {
            if (step(i) < 0) share = std::min(share, -from(i) / step(i));
        }
        return share;
    }

    const OrderedQp& qp_;
    const Eigen::VectorXd& c_;
    const std::vector<OrderConstraint>& constraints_;
    std::vector<Places> places_;
    Eigen::SparseMatrix<double> system_;
    double unit_;
    Eigen::VectorXd x_, s_, z_;
    Eigen::VectorXd dual_, primal_;
    double residual_ = 0;
};

OrderedQp::OrderedQp(const Eigen::SparseMatrix<double>& Q)
    : Q_(Q), lower_(Q.triangularView<Eigen::Lower>()), diagonal_(Q.diagonal()), pattern_(lower_) {}

std::optional<OrderedQpSolution> OrderedQp::solve(const Eigen::VectorXd& c,
                                                  const std::vector<OrderConstraint>& constraints,
                                                  const Eigen::VectorXd& start, const QpOptions& options) const {
    OrderedQpIteration iteration(*this, c, constraints, start);
    OrderedQpSolution best;
    best.x = start;
    best.kkt_residual = std::numeric_limits<double>::infinity();
    // Past the smallest residual that round-off allows, iterations only wander.
    constexpr int most_in_vain = 10;
    int in_vain = 0;
    while (best.iterations < options.max_iterations && in_vain < most_in_vain) {
        if (options.on_iteration) options.on_iteration();
        ++best.iterations;
        if (!iteration.step()) {
            if (best.iterations == 1) return std::nullopt;
            break;
        }
        ++in_vain;
        if (iteration.kkt_residual() < best.kkt_residual) {
            best.x = iteration.x();
            best.kkt_residual = iteration.kkt_residual();
            in_vain = 0;
        }
        best.converged = best.kkt_residual <= options.tolerance;
        if (best.converged) break;
    }
    return best;
}

}  // namespace puppetwarp
