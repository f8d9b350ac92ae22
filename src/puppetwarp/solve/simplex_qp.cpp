#include <puppetwarp/solve/simplex_qp.h>

#include <puppetwarp/solve/supernodal_cholesky.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <utility>

namespace puppetwarp {

namespace {

// Armijo's share of the descent that the gradient promises, and the shortest step along the arc.
constexpr double sufficient_share = 1e-4;
constexpr double shortest_step = 1e-10;

using SparseMatrix = Eigen::SparseMatrix<double>;

// Q W for a symmetric Q.
Shares product(const SparseMatrix& Q, const Shares& W) {
    Shares G = Shares::Zero(W.rows(), W.cols());
    for (Eigen::Index v = 0; v < W.rows(); ++v) {
        for (SparseMatrix::InnerIterator it(Q, v); it; ++it) G.row(v) += it.value() * W.row(it.row());
    }
    return G;
}

int largest(const Shares& W, Eigen::Index row) {
    Eigen::Index column = 0;
    W.row(row).maxCoeff(&column);
    return static_cast<int>(column);
}

// Rows of shares at least 0 that sum to 1.
void put_on_simplex(Shares& W, const std::vector<char>& given) {
    for (Eigen::Index v = 0; v < W.rows(); ++v) {
        if (given[static_cast<std::size_t>(v)] != 0) continue;
        W.row(v) = W.row(v).cwiseMax(0);
        W.row(v) /= W.row(v).sum();
    }
}

class SimplexSolver {
public:
    SimplexSolver(const SimplexQp& problem, const Shares& start, const QpOptions& options)
        : qp_(problem),
          options_(options),
          sign_(sign_share * options.tolerance),
          diagonal_(problem.Q.diagonal()),
          n_(start.rows()),
          m_(start.cols()),
          held_(static_cast<std::size_t>(start.size()), 0),
          pivot_(static_cast<std::size_t>(n_), 0) {
        result_.W = start;
        for (Eigen::Index v = 0; v < n_; ++v) {
            for (Eigen::Index j = 0; j < m_; ++j) held(v, j) = start(v, j) <= 0 ? 1 : 0;
        }
    }

    std::optional<SimplexQpSolution> run() {
        const bool settled = settle_active_set();
        if (definite_ && !settled) descend();
        if (!definite_) return std::nullopt;
        put_on_simplex(result_.W, qp_.given);
        result_.kkt_residual = simplex_kkt_residual(qp_, result_.W);
        result_.converged = result_.kkt_residual <= options_.tolerance;
        return std::move(result_);
    }

private:
    char& held(Eigen::Index v, Eigen::Index j) { return held_[static_cast<std::size_t>(v * m_ + j)]; }
    bool given(Eigen::Index v) const { return qp_.given[static_cast<std::size_t>(v)] != 0; }
    int pivot(Eigen::Index v) const { return pivot_[static_cast<std::size_t>(v)]; }

    // \return whether no share wants to change sides.
    bool settle_active_set() {
        VisitedSets visited;
        const int most = std::max(1, options_.max_iterations / 2);
        while (result_.iterations < most && visited.note(held_)) {
            choose_pivots();
            result_.W = minimise_unheld();
            if (!definite_) return false;
            const Shares G = product(qp_.Q, result_.W);
            bool changed = change_sides(G);
            if (good_enough()) return true;
            // Many shares a little below 0 are together more than the tolerance.
            while (!changed && tighten(sign_, options_.tolerance)) changed = change_sides(G);
            if (!changed) return true;
        }
        return false;
    }

    // Whether the last sides, though some would still change, are those of a solution to the tolerance.
    bool good_enough() const {
        Shares W = result_.W;
        put_on_simplex(W, qp_.given);
        return simplex_kkt_residual(qp_, W) <= options_.tolerance;
    }

    // The largest share of a row that is not held, so that what it takes from the others leaves it far from 0.
    void choose_pivots() {
        for (Eigen::Index v = 0; v < n_; ++v) {
            if (given(v)) continue;
            int best = -1;
            for (int j = 0; j < m_; ++j) {
                if (held(v, j) == 0 && (best < 0 || result_.W(v, j) > result_.W(v, best))) best = j;
            }
            if (best < 0) {
                best = largest(result_.W, v);
                held(v, best) = 0;
            }
            pivot_[static_cast<std::size_t>(v)] = best;
        }
    }

    // \return whether any did.
    bool change_sides(const Shares& G) { return change_sides(G, true) || change_sides(G, false); }

    // \param at_edges  released are only shares beside ones that are not held. Others that seem to ask for it hardly
    // ever mean it: far from its handle, what pushes a share is 0 but for the errors of sets that are not the last.
    bool change_sides(const Shares& G, bool at_edges) {
        const std::string before = held_;
        for (Eigen::Index v = 0; v < n_; ++v) {
            if (given(v)) continue;
            for (Eigen::Index j = 0; j < m_; ++j) {
                const bool was_held = held_at(before, v, j);
                const bool wants_to =
                    was_held ? G(v, j) - G(v, pivot(v)) >= -sign_ * diagonal_(v) : result_.W(v, j) < -sign_;
                held(v, j) = wants_to || (was_held && at_edges && !beside_unheld(before, v, j)) ? 1 : 0;
            }
        }
        return held_ != before;
    }

    bool held_at(const std::string& sides, Eigen::Index v, Eigen::Index j) const {
        return given(v) ? result_.W(v, j) <= 0 : sides[static_cast<std::size_t>(v * m_ + j)] != 0;
    }
    bool beside_unheld(const std::string& sides, Eigen::Index v, Eigen::Index j) const {
        for (SparseMatrix::InnerIterator it(qp_.Q, v); it; ++it) {
            if (!held_at(sides, it.row(), j)) return true;
        }
        return false;
    }

    // Bertsekas' two-metric projection: shares at 0 that want to stay are held, a Newton step in the others, bent at 0.
    void descend() {
        put_on_simplex(result_.W, qp_.given);
        while (result_.iterations < options_.max_iterations) {
            if (simplex_kkt_residual(qp_, result_.W) <= sign_) return;
            const Shares G = product(qp_.Q, result_.W);
            result_.safeguarded = true;
            hold_what_stays(G);
            const Shares target = minimise_unheld();
            if (!definite_ || !step_towards(target, G)) return;
        }
    }

    void hold_what_stays(const Shares& G) {
        // Nearer to 0 than this counts as being there, or steps would shrink in front of it.
        const double near = std::min(1e-6, 0.1 / static_cast<double>(m_));
        for (Eigen::Index v = 0; v < n_; ++v) {
            if (given(v)) continue;
            const int p = largest(result_.W, v);
            pivot_[static_cast<std::size_t>(v)] = p;
            for (Eigen::Index j = 0; j < m_; ++j) {
                held(v, j) = result_.W(v, j) <= near && G(v, j) > G(v, p) ? 1 : 0;
            }
        }
    }

    bool step_towards(const Shares& target, const Shares& G) {
        for (double step = 1; step > shortest_step; step /= 2) {
            const Shares W = bent(result_.W + step * (target - result_.W));
            const Shares way = W - result_.W;
            const double slope = G.cwiseProduct(way).sum();
            if (slope >= 0) continue;
            if (slope + 0.5 * way.cwiseProduct(product(qp_.Q, way)).sum() <= sufficient_share * slope) {
                result_.W = W;
                return true;
            }
        }
        return false;
    }

    // Shares below 0 are cut off at the pivot's expense; where that has not enough, all give.
    Shares bent(Shares W) const {
        for (Eigen::Index v = 0; v < n_; ++v) {
            if (given(v)) continue;
            auto row = W.row(v);
            row(pivot(v)) = 0;
            row = row.cwiseMax(0);
            const double others = row.sum();
            if (others <= 1) {
                row(pivot(v)) = 1 - others;
            } else {
                row /= others;
            }
        }
        return W;
    }

    // Which unknown a share is, or -1.
    std::vector<int> number_unknowns() {
        std::vector<int> unknown(held_.size(), -1);
        size_ = 0;
        for (Eigen::Index v = 0; v < n_; ++v) {
            if (given(v)) continue;
            for (int j = 0; j < m_; ++j) {
                if (held(v, j) == 0 && j != pivot(v)) unknown[static_cast<std::size_t>(v * m_ + j)] = size_++;
            }
        }
        return unknown;
    }

    // All of each row at its pivot.
    Shares pivots_only() const {
        Shares W = Shares::Zero(n_, m_);
        for (Eigen::Index v = 0; v < n_; ++v) {
            if (given(v)) {
                W.row(v) = result_.W.row(v);
            } else {
                W(v, pivot(v)) = 1;
            }
        }
        return W;
    }

    // Lower triangle of the energy's second derivative in the unknowns: moving shares y_vj from pivots p(v) to columns
    // j and y_uk from p(u) to k together costs Q_vu where both leave or both reach a column, -Q_vu where one leaves
    // what the other reaches.
    SparseMatrix reduced_matrix(const std::vector<int>& unknown) const {
        SparseMatrix S(size_, size_);
        S.reserve(2 * qp_.Q.nonZeros());
        for (Eigen::Index v = 0; v < n_; ++v) {
            for (int j = 0; j < m_; ++j) {
                const int column = unknown[static_cast<std::size_t>(v * m_ + j)];
                if (column < 0) continue;
                S.startVec(column);
                for (SparseMatrix::InnerIterator it(qp_.Q, v); it; ++it) {
                    const Eigen::Index u = it.row();
                    if (u < v || given(u)) continue;
                    for (int k = 0; k < m_; ++k) {
                        const int row = unknown[static_cast<std::size_t>(u * m_ + k)];
                        if (row < column) continue;
                        const int both = (j == k ? 1 : 0) + (pivot(v) == pivot(u) ? 1 : 0);
                        const int apart = (j == pivot(u) ? 1 : 0) + (k == pivot(v) ? 1 : 0);
                        if (both != apart) S.insertBack(row, column) = (both - apart) * it.value();
                    }
                }
            }
        }
        S.finalize();
        return S;
    }

    // The minimiser over what is not held, signs forgotten.
    Shares minimise_unheld() {
        if (options_.on_iteration) options_.on_iteration();
        ++result_.iterations;
        const std::vector<int> unknown = number_unknowns();
        Shares W = pivots_only();
        if (size_ == 0) return W;
        const Shares G = product(qp_.Q, W);
        Eigen::VectorXd y(size_);
        for_each_unknown(unknown, [&](Eigen::Index v, int j, int k) { y(k) = G(v, pivot(v)) - G(v, j); });
        const SparseMatrix S = reduced_matrix(unknown);
        const std::optional<SupernodalCholesky> factor = SupernodalCholesky::factorise(S);
        definite_ = factor.has_value();
        if (!definite_) return W;
        factor->solve_in_place(y);
        for_each_unknown(unknown, [&](Eigen::Index v, int j, int k) {
            W(v, j) += y(k);
            W(v, pivot(v)) -= y(k);
        });
        return W;
    }

    template <typename Visit>
    void for_each_unknown(const std::vector<int>& unknown, const Visit& visit) const {
        for (Eigen::Index v = 0; v < n_; ++v) {
            for (int j = 0; j < m_; ++j) {
                const int k = unknown[static_cast<std::size_t>(v * m_ + j)];
                if (k >= 0) visit(v, j, k);
            }
        }
    }

    const SimplexQp& qp_;
    const QpOptions& options_;
    double sign_;
    Eigen::VectorXd diagonal_;
    Eigen::Index n_, m_;
    std::string held_;  // n x m, one row's shares beside each other: whether a share is held at 0
    std::vector<int> pivot_;
    int size_ = 0;  // unknowns
    bool definite_ = true;
    SimplexQpSolution result_;
};

}  // namespace

double simplex_kkt_residual(const SimplexQp& problem, const Shares& W) {
    const Shares G = product(problem.Q, W);
    const Eigen::VectorXd diagonal = problem.Q.diagonal();
    double residual = 0;
    for (Eigen::Index v = 0; v < W.rows(); ++v) {
        if (problem.given[static_cast<std::size_t>(v)] != 0) continue;
        const double at_pivot = G(v, largest(W, v));
        for (Eigen::Index j = 0; j < W.cols(); ++j) {
            const double mu = G(v, j) - at_pivot;
            residual = std::max(residual, (W(v, j) > 0 ? std::abs(mu) : -mu) / diagonal(v));
        }
    }
    return residual;
}

std::optional<SimplexQpSolution> solve_simplex_qp(const SimplexQp& problem, const Shares& start,
                                                  const QpOptions& options) {
    assert(problem.Q.rows() == start.rows() && problem.given.size() == static_cast<std::size_t>(start.rows()));
    return SimplexSolver(problem, start, options).run();
}

}  // namespace puppetwarp
