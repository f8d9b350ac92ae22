#include <puppetwarp/deform/response_system.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace puppetwarp {

namespace {

// Below this share of the largest pivot a row counts as a combination of others.
constexpr double rank_threshold = 1e-13;

std::complex<double> y_factor(GradientGoal::Row row) {
    return {0.0, row == GradientGoal::Row::turn ? -0.5 : 0.5};
}

// Turns the wanted values of free direction into those of least change^H stiffness change.
void settle_directions(const Eigen::MatrixXcd& stiffness, std::vector<GradientGoal>& goals) {
    constexpr int most_sweeps = 1000;
    constexpr double settled = 1e-15;
    Eigen::VectorXcd change(static_cast<Eigen::Index>(goals.size()));
    for (std::size_t i = 0; i < goals.size(); ++i) {
        GradientGoal& goal = goals[i];
        if (goal.scale > 0)
            goal.wanted = std::abs(goal.now) > 0 ? goal.now / std::abs(goal.now) * goal.scale : goal.scale;
        change(static_cast<Eigen::Index>(i)) = goal.wanted - goal.now;
    }
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
        double moved = 0;
        for (std::size_t i = 0; i < goals.size(); ++i) {
            GradientGoal& goal = goals[i];
            if (!(goal.scale > 0)) continue;
            const auto row = static_cast<Eigen::Index>(i);
            const std::complex<double> pull = stiffness(row, row) * goal.wanted - (stiffness.row(row) * change).value();
            if (!(std::abs(pull) > 0)) continue;
            const std::complex<double> next = pull / std::abs(pull) * goal.scale;
            moved = std::max(moved, std::abs(next - goal.wanted) / goal.scale);
            goal.wanted = next;
            change(row) = next - goal.now;
        }
        if (moved <= settled) return;
    }
}

}  // namespace

ResponseSystem::ResponseSystem(Compliance compliance) : compliance_(std::move(compliance)) {
    const Eigen::Index m = compliance_.means.rows();
    const Eigen::Index c = compliance_.constants;
    // A hold within held vertices responds to nothing: it gets the size of the others.
    const Eigen::VectorXd diagonal = compliance_.means.diagonal();
    const double typical = m == 0 ? 1 : std::max(diagonal.mean(), 1e-300);
    scale_ = Eigen::VectorXd::Constant(m + c, std::sqrt(typical));
    for (Eigen::Index i = 0; i < m; ++i) scale_(i) = 1 / std::sqrt(std::max(diagonal(i), 1e-6 * typical));
    // [ means  ones ]
    // [ ones^T  0   ] scaled to similar size.
    Eigen::MatrixXd saddle = Eigen::MatrixXd::Zero(m + c, m + c);
    saddle.topLeftCorner(m, m) = compliance_.means;
    for (Eigen::Index i = 0; i < m; ++i) {
        const int constant = compliance_.constant_of[static_cast<std::size_t>(i)];
        if (constant >= 0) saddle(i, m + constant) = saddle(m + constant, i) = 1;
    }
    means_solver_.setThreshold(rank_threshold);
    if (m > 0) means_solver_.compute(scale_.asDiagonal() * saddle * scale_.asDiagonal());
    const Eigen::MatrixXd across = compliance_.gradient_means.transpose();
    undone_ = solve_means(across);
    constrained_ = compliance_.gradients - compliance_.gradient_means * undone_.topRows(m);
}

// Multipliers of the means and constants that give the means these values. #holds x #fields
template <typename Values>
Values ResponseSystem::solve_means(const Values& means) const {
    Values b = Values::Zero(scale_.size(), means.cols());
    if (means.rows() == 0) return b;
    b.topRows(means.rows()) = means;
    return scale_.asDiagonal() * means_solver_.solve(scale_.asDiagonal() * b);
}

Eigen::MatrixXcd ResponseSystem::goal_compliance(const std::vector<GradientGoal>& goals) const {
    const auto count = static_cast<Eigen::Index>(goals.size());
    Eigen::MatrixXcd S(count, count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const GradientGoal& a = goals[static_cast<std::size_t>(i)];
        const Complex ay = y_factor(a.row);
        for (Eigen::Index j = 0; j < count; ++j) {
            const GradientGoal& b = goals[static_cast<std::size_t>(j)];
            const Complex by = std::conj(y_factor(b.row));
            const Eigen::Matrix2d s = constrained_.block<2, 2>(2 * a.hold, 2 * b.hold);
            S(i, j) = 0.25 * s(0, 0) + 0.5 * s(0, 1) * by + 0.5 * s(1, 0) * ay + s(1, 1) * ay * by;
        }
    }
    return S;
}

ResponseSystem::Multipliers ResponseSystem::solve(const Eigen::VectorXcd& means,
                                                  std::vector<GradientGoal>& goals) const {
    const Eigen::Index m = means.size();
    Eigen::MatrixXd parts(m, 2);
    parts << means.real(), means.imag();
    const Eigen::MatrixXd solution = solve_means(parts);
    Eigen::VectorXcd multipliers(solution.rows());
    multipliers.real() = solution.col(0);
    multipliers.imag() = solution.col(1);
    Eigen::VectorXcd on_gradients = Eigen::VectorXcd::Zero(compliance_.gradients.rows());
    if (!goals.empty()) {
        const Eigen::VectorXcd slopes = compliance_.gradient_means * multipliers.head(m);
        for (GradientGoal& goal : goals) {
            goal.now += 0.5 * slopes(2 * goal.hold) + y_factor(goal.row) * slopes(2 * goal.hold + 1);
        }
        Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXcd> compliance;
        compliance.setThreshold(rank_threshold);
        compliance.compute(goal_compliance(goals));
        const bool some_free =
            std::any_of(goals.begin(), goals.end(), [](const GradientGoal& goal) { return goal.scale > 0; });
        if (some_free) settle_directions(compliance.pseudoInverse(), goals);
        Eigen::VectorXcd change(static_cast<Eigen::Index>(goals.size()));
        for (std::size_t i = 0; i < goals.size(); ++i) {
            change(static_cast<Eigen::Index>(i)) = goals[i].wanted - goals[i].now;
        }
        const Eigen::VectorXcd on_goals = compliance.solve(change);
        for (std::size_t i = 0; i < goals.size(); ++i) {
            const Complex multiplier = on_goals(static_cast<Eigen::Index>(i));
            on_gradients(2 * goals[i].hold) += 0.5 * multiplier;
            on_gradients(2 * goals[i].hold + 1) += std::conj(y_factor(goals[i].row)) * multiplier;
        }
        multipliers -= undone_ * on_gradients;
    }
    return {multipliers.head(m), on_gradients, multipliers.tail(compliance_.constants)};
}

}  // namespace puppetwarp
