#include <puppetwarp/deform/turn_goals.h>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// A disc that shrank to this share of its size counts as crushed.
constexpr double crushed = 0.1;
// Lengths are met to this share, by following their directions at most so often.
constexpr double settled = 1e-13;
constexpr int most_passes = 40;
constexpr double rank_threshold = 1e-13;

// One real equation: Re(conj(direction) f(row)) = value.
struct Equation {
    int row;
    Complex direction;
    double value;
};

Complex direction_of(const Complex& z, const Complex& otherwise) {
    const double length = std::abs(z);
    return length > 0 ? z / length : otherwise / std::abs(otherwise);
}

void add_equations(const RowGoal& goal, std::vector<Equation>& equations) {
    const Complex ahead = direction_of(goal.value, 1);
    switch (goal.kind) {
        case RowGoal::Kind::value:
            equations.push_back({goal.row, 1, goal.value.real()});
            equations.push_back({goal.row, Complex(0, 1), goal.value.imag()});
            break;
        case RowGoal::Kind::direction: equations.push_back({goal.row, ahead * Complex(0, 1), 0}); break;
        case RowGoal::Kind::length: equations.push_back({goal.row, ahead, std::abs(goal.value)}); break;
    }
}

double real_product(const Complex& a, const Complex& b) {
    return a.real() * b.real() + a.imag() * b.imag();
}

// [ response  modes ] over the equations and both parts of each mode's coefficient, rows scaled to similar size.
// [ modes^T   0     ]
RowSteps solve(const std::vector<Equation>& equations, const Eigen::VectorXcd& f0, const Eigen::MatrixXcd& response,
               const Eigen::MatrixXcd& modes) {
    const auto count = static_cast<Eigen::Index>(equations.size());
    const Eigen::Index size = count + 2 * modes.cols();
    RowSteps steps{Eigen::VectorXcd::Zero(f0.size()), Eigen::VectorXcd::Zero(modes.cols())};
    if (count == 0) return steps;
    Eigen::MatrixXd saddle = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(size);
    for (Eigen::Index i = 0; i < count; ++i) {
        const Equation& at = equations[static_cast<std::size_t>(i)];
        for (Eigen::Index j = 0; j < count; ++j) {
            const Equation& from = equations[static_cast<std::size_t>(j)];
            saddle(i, j) = real_product(at.direction, response(at.row, from.row) * from.direction);
        }
        for (Eigen::Index k = 0; k < modes.cols(); ++k) {
            saddle(i, count + 2 * k) = real_product(at.direction, modes(at.row, k));
            saddle(i, count + 2 * k + 1) = real_product(at.direction, Complex(0, 1) * modes(at.row, k));
        }
        b(i) = at.value - real_product(at.direction, f0(at.row));
    }
    saddle.bottomLeftCorner(size - count, count) = saddle.topRightCorner(count, size - count).transpose();
    Eigen::VectorXd scale = Eigen::VectorXd::Ones(size);
    for (Eigen::Index i = 0; i < count; ++i) {
        if (saddle(i, i) > 0) scale(i) = 1 / std::sqrt(saddle(i, i));
    }
    // One for both parts of a mode: the least of all solutions then favours no direction.
    for (Eigen::Index k = count; k < size; k += 2) {
        const double length = (scale.head(count).asDiagonal() * saddle.block(0, k, count, 2)).norm();
        if (length > 0) scale(k) = scale(k + 1) = 1 / length;
    }
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    solver.setThreshold(rank_threshold);
    solver.compute(scale.asDiagonal() * saddle * scale.asDiagonal());
    const Eigen::VectorXd y = scale.cwiseProduct(solver.solve(scale.cwiseProduct(b)));

    for (Eigen::Index i = 0; i < count; ++i) {
        const Equation& at = equations[static_cast<std::size_t>(i)];
        steps.multipliers(at.row) += y(i) * at.direction;
    }
    for (Eigen::Index k = 0; k < modes.cols(); ++k) steps.modes(k) = Complex(y(count + 2 * k), y(count + 2 * k + 1));
    return steps;
}

}  // namespace

double distance_to(const RowGoal& goal, const Complex& row) {
    switch (goal.kind) {
        case RowGoal::Kind::direction: return std::abs((std::conj(direction_of(goal.value, 1)) * row).imag());
        case RowGoal::Kind::length: return std::abs(std::abs(row) - std::abs(goal.value));
        case RowGoal::Kind::value: break;
    }
    return std::abs(row - goal.value);
}

RowSteps meet(const std::vector<RowGoal>& goals, const Eigen::VectorXcd& f0, const Eigen::MatrixXcd& response,
              const Eigen::MatrixXcd& modes) {
    std::vector<RowGoal> now = goals;
    RowSteps steps;
    for (int pass = 0; pass < most_passes; ++pass) {
        std::vector<Equation> equations;
        for (const RowGoal& goal : now) {
            // The first time rows of a given length are left alone, to see where they point of themselves.
            if (pass > 0 || goal.kind != RowGoal::Kind::length) add_equations(goal, equations);
        }
        steps = solve(equations, f0, response, modes);
        const Eigen::VectorXcd f = f0 + response * steps.multipliers + modes * steps.modes;
        bool changed = false;
        for (RowGoal& goal : now) {
            const double length = std::abs(goal.value);
            if (goal.kind == RowGoal::Kind::length) {
                changed |= std::abs(std::abs(f(goal.row)) - length) > settled * length;
                const bool crushed_flat = std::abs(f(goal.row)) <= crushed * settled * length;
                if (!crushed_flat) goal.value = length * direction_of(f(goal.row), goal.value);
                if (pass == most_passes - 2) goal.kind = RowGoal::Kind::value;
            } else if (goal.kind == RowGoal::Kind::direction &&
                       real_product(goal.value, f(goal.row)) <= crushed * length * length) {
                // The line of a direction goes on behind 0, where it means a half turn too many.
                goal.kind = RowGoal::Kind::value;
                changed = true;
            }
        }
        if (!changed) break;
    }
    return steps;
}

}  // namespace puppetwarp
