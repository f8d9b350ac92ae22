#include <puppetwarp/solve/box_qp.h>

#include <puppetwarp/solve/cholesky.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace puppetwarp {

namespace {

// Armijo's share of the descent that the gradient promises, and the shortest step along the arc.
constexpr double sufficient_share = 1e-4;
constexpr double shortest_step = 1e-10;

enum Side : char { inside, at_lower, at_upper, given };

class BoxSolver {
public:
    BoxSolver(const BoxQp& problem, const Eigen::VectorXd& start, const QpOptions& options)
        : qp_(problem),
          options_(options),
          sign_(sign_share * options.tolerance),
          diagonal_(problem.Q.diagonal()),
          side_(static_cast<std::size_t>(start.size()), inside) {
        result_.x = start;
        for (int v = 0; v < start.size(); ++v) {
            char& side = side_[static_cast<std::size_t>(v)];
            if (qp_.lower(v) == qp_.upper(v)) {
                side = given;
            } else if (start(v) <= qp_.lower(v)) {
                side = at_lower;
            } else if (start(v) >= qp_.upper(v)) {
                side = at_upper;
            }
        }
    }

    std::optional<BoxQpSolution> run() {
        const bool settled = settle_active_set();
        if (definite_ && !settled) descend();
        if (!definite_) return std::nullopt;
        result_.x = clipped(result_.x);
        result_.kkt_residual = kkt_residual(result_.x, gradient());
        result_.converged = result_.kkt_residual <= options_.tolerance;
        return std::move(result_);
    }

private:
    Eigen::VectorXd gradient() const { return qp_.Q * result_.x + qp_.c; }
    Eigen::VectorXd clipped(const Eigen::VectorXd& x) const { return x.cwiseMax(qp_.lower).cwiseMin(qp_.upper); }

    // \return whether no variable wants to change sides.
    bool settle_active_set() {
        VisitedSets visited;
        const int most = std::max(1, options_.max_iterations / 2);
        while (result_.iterations < most && visited.note(side_)) {
            result_.x = minimise_inside();
            if (!definite_) return false;
            const Eigen::VectorXd g = gradient();
            bool changed = change_sides(g);
            if (!changed && good_enough()) return true;
            // Many variables a little beyond a bound are together more than the tolerance.
            while (!changed && tighten(sign_, options_.tolerance)) changed = change_sides(g);
            if (!changed) return true;
        }
        return false;
    }

    // Whether what is a little beyond its bounds may be clipped.
    bool good_enough() const {
        const Eigen::VectorXd x = clipped(result_.x);
        return kkt_residual(x, qp_.Q * x + qp_.c) <= options_.tolerance;
    }

    bool change_sides(const Eigen::VectorXd& g) {
        bool changed = false;
        for (int v = 0; v < g.size(); ++v) {
            char& side = side_[static_cast<std::size_t>(v)];
            const char before = side;
            const double x = result_.x(v);
            if (side == inside) {
                if (x < qp_.lower(v) - sign_) side = at_lower;
                if (x > qp_.upper(v) + sign_) side = at_upper;
            } else if (side != given && (side == at_lower ? -g(v) : g(v)) > sign_ * diagonal_(v)) {
                side = inside;
            }
            changed = changed || side != before;
        }
        return changed;
    }

    // Bertsekas' two-metric projection: what is at a bound and wants to stay is held, a Newton step in the others, bent
    // at the bounds.
    void descend() {
        result_.x = clipped(result_.x);
        while (result_.iterations < options_.max_iterations) {
            const Eigen::VectorXd g = gradient();
            if (kkt_residual(result_.x, g) <= sign_) return;
            result_.safeguarded = true;
            hold_what_stays(g);
            const Eigen::VectorXd target = minimise_inside();
            if (!definite_ || !step_towards(target, g)) return;
        }
    }

    void hold_what_stays(const Eigen::VectorXd& g) {
        for (int v = 0; v < g.size(); ++v) {
            char& side = side_[static_cast<std::size_t>(v)];
            if (side == given) continue;
            // Nearer to a bound than this counts as being there, or steps would shrink in front of it.
            const double near = std::min(1e-6, 0.1 * (qp_.upper(v) - qp_.lower(v)));
            side = inside;
            if (result_.x(v) <= qp_.lower(v) + near && g(v) > 0) side = at_lower;
            if (result_.x(v) >= qp_.upper(v) - near && g(v) < 0) side = at_upper;
        }
    }

    bool step_towards(const Eigen::VectorXd& target, const Eigen::VectorXd& g) {
        for (double step = 1; step > shortest_step; step /= 2) {
            const Eigen::VectorXd x = clipped(result_.x + step * (target - result_.x));
            const Eigen::VectorXd way = x - result_.x;
            const double slope = g.dot(way);
            if (slope < 0 && slope + 0.5 * way.dot(qp_.Q * way) <= sufficient_share * slope) {
                result_.x = x;
                return true;
            }
        }
        return false;
    }

    double kkt_residual(const Eigen::VectorXd& x, const Eigen::VectorXd& g) const {
        double residual = 0;
        for (int v = 0; v < g.size(); ++v) {
            if (side_[static_cast<std::size_t>(v)] == given) continue;
            double pull = std::abs(g(v));
            if (x(v) <= qp_.lower(v)) pull = -g(v);
            if (x(v) >= qp_.upper(v)) pull = g(v);
            residual = std::max(residual, pull / diagonal_(v));
        }
        return residual;
    }

    // The minimiser over what is inside, bounds forgotten, with the others at theirs.
    Eigen::VectorXd minimise_inside() {
        if (options_.on_iteration) options_.on_iteration();
        ++result_.iterations;
        const std::size_t n = side_.size();
        Eigen::VectorXd x(static_cast<Eigen::Index>(n));
        std::vector<int> slot(n, -1), free;
        for (std::size_t v = 0; v < n; ++v) {
            const auto i = static_cast<Eigen::Index>(v);
            x(i) = side_[v] == at_upper ? qp_.upper(i) : side_[v] == inside ? 0 : qp_.lower(i);
            if (side_[v] != inside) continue;
            slot[v] = static_cast<int>(free.size());
            free.push_back(static_cast<int>(v));
        }
        if (free.empty()) return x;
        const auto size = static_cast<Eigen::Index>(free.size());
        Eigen::SparseMatrix<double> lower(size, size);
        Eigen::VectorXd b(size);
        lower.reserve(qp_.Q.nonZeros() / 2 + size);
        for (Eigen::Index k = 0; k < size; ++k) {
            const int v = free[static_cast<std::size_t>(k)];
            lower.startVec(k);
            double load = qp_.c(v);
            for (Eigen::SparseMatrix<double>::InnerIterator it(qp_.Q, v); it; ++it) {
                const int row = slot[static_cast<std::size_t>(it.row())];
                if (row >= k) lower.insertBack(row, k) = it.value();
                if (row < 0) load += it.value() * x(it.row());
            }
            b(k) = -load;
        }
        lower.finalize();
        const std::optional<CholeskyFactor> factor = CholeskyPattern(lower).factorise(lower);
        definite_ = factor.has_value();
        if (!definite_) return x;
        factor->solve_in_place(b);
        x(free) = b;
        return x;
    }

    const BoxQp& qp_;
    const QpOptions& options_;
    double sign_;
    Eigen::VectorXd diagonal_;
    std::string side_;  // of each variable, as Side
    bool definite_ = true;
    BoxQpSolution result_;
};

}  // namespace

std::optional<BoxQpSolution> solve_box_qp(const BoxQp& problem, const Eigen::VectorXd& start,
                                          const QpOptions& options) {
    assert(problem.Q.rows() == start.size() && problem.c.size() == start.size());
    return BoxSolver(problem, start, options).run();
}

}  // namespace puppetwarp
