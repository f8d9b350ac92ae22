#include <puppetwarp/weights/l1.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/solve/box_qp.h>
#include <puppetwarp/weights/bounded_biharmonic.h>
#include <puppetwarp/weights/row_sums.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace puppetwarp {

namespace {

// How much of the budget may be left over.
constexpr double slack = 1e-3;
constexpr int most_tries = 60;
// Share of the progress that goes to the weights without a budget.
constexpr double first_share = 0.3;

// The first part of a longer work.
class FirstPart final : public Progress {
public:
    explicit FirstPart(Progress& whole) : whole_(whole) {}
    bool cancelled() const override { return whole_.cancelled(); }

private:
    void show(std::string_view stage, double fraction) override { whole_.step(stage, first_share * fraction); }

    Progress& whole_;
};

// One column: its weights for a price of the integral, and the price that the budget asks for.
class Column {
public:
    Column(const SparseMatrix& Q, const Eigen::VectorXd& mass, const WeightProblem& problem, const QpOptions& options,
           const Eigen::VectorXd& unbudgeted)
        : Q_(Q),
          mass_(mass),
          options_(options),
          lower_(Eigen::VectorXd::Zero(Q.rows())),
          upper_(Eigen::VectorXd::Ones(Q.rows())),
          w_(unbudgeted) {
        for (const int v : problem.conditions.vertices) {
            lower_(v) = upper_(v) = unbudgeted(v);
            mass_(v) = 0;
        }
        mass_ /= std::max(mass_.sum(), std::numeric_limits<double>::min());
    }

    void spend(double budget_share) {
        const double most = budget_share * integral();
        if (!(most > 0) || budget_share >= 1) return;
        // The price at which the integral costs what the weights cost bent; of a constant that is nothing.
        const double least_energy = 1e-12 * Q_.diagonal().mean();
        double low = 0, high = std::max(w_.dot(Q_ * w_), least_energy) / integral();
        while (solve(high) > most && ++tries_ < most_tries) {
            low = high;
            high *= 8;
        }
        // The integral falls steadily with the price.
        const auto spent = [&] { return integral() <= most && integral() >= (1 - slack) * most; };
        while (!spent() && ++tries_ < most_tries) {
            const double middle = low > 0 ? std::sqrt(low * high) : high / 8;
            if (!(low < middle && middle < high)) break;
            (solve(middle) > most ? low : high) = middle;
        }
        if (integral() > most) solve(high);
        settled_ = last_.converged && integral() <= most;
    }

    const BoxQpSolution& last() const { return last_; }
    // Whether the budget is kept by a solution.
    bool settled() const { return settled_; }
    const Eigen::VectorXd& w() const { return w_; }
    int iterations() const { return iterations_; }
    bool safeguarded() const { return safeguarded_; }

private:
    double integral() const { return mass_.dot(w_); }

    // \return the integral.
    double solve(double price) {
        const Eigen::VectorXd c = price * mass_;
        const auto found = solve_box_qp({Q_, c, lower_, upper_}, w_, options_);
        if (!found) {
            throw InvalidInput("mesh", "its triangles are too thin or too different in size to compute weights with",
                               "use a mesh with better triangles");
        }
        last_ = *found;
        w_ = last_.x;
        iterations_ += last_.iterations;
        safeguarded_ |= last_.safeguarded;
        return integral();
    }

    const SparseMatrix& Q_;
    Eigen::VectorXd mass_;  // of what is free, sum 1
    QpOptions options_;
    Eigen::VectorXd lower_, upper_, w_;
    BoxQpSolution last_;
    int iterations_ = 0;
    int tries_ = 0;
    bool safeguarded_ = false;
    bool settled_ = true;
};

}  // namespace

WeightSolution l1_functions(const WeightProblem& problem, const WeightOptions& options, Progress& progress) {
    FirstPart first(progress);
    WeightSolution found = bounded_biharmonic_functions(problem, options, first);
    if (options.l1_budget >= 1) return found;
    const SparseMatrix Q = laplacian_energy(problem);
    const Eigen::VectorXd mass = lumped_mass(problem.mesh);
    const QpOptions limits{options.tolerance, options.max_iterations, [&] {
                               if (progress.cancelled()) throw Cancelled();
                           }};
    found.kkt_residual = 0;
    for (Eigen::Index j = 0; j < found.W.cols(); ++j) {
        const double done = static_cast<double>(j) / static_cast<double>(found.W.cols());
        progress.step("weights", first_share + (1 - first_share) * done);
        Column column(Q, mass, problem, limits, found.W.col(j));
        column.spend(options.l1_budget);
        found.W.col(j) = column.w();
        if (column.iterations() == 0) continue;  // nothing is free
        found.iterations += column.iterations();
        found.converged &= column.settled();
        found.kkt_residual = std::max(found.kkt_residual, column.last().kkt_residual);
        if (column.safeguarded()) found.fallback = "projected Newton";
    }
    return found;
}

WeightSolution l1_weights(const WeightProblem& problem, const WeightOptions& options, Progress& progress) {
    WeightSolution solution = l1_functions(problem, options, progress);
    divide_by_row_sums(problem.mesh, solution.W);
    return solution;
}

}  // namespace puppetwarp
