#include <puppetwarp/weights/monotonic.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/solve/ordered_qp.h>
#include <puppetwarp/weights/row_sums.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

namespace puppetwarp {

namespace {

// The function from which the graph is read first needs no more than its order.
constexpr double first_tolerance = 1e-3;
// Least edge weight, as a share of an equilateral triangle's: positive weights alone give a maximum principle.
constexpr double least_edge_weight = 0.05;

// A stiffness whose edge weights are positive: the cotangent one where that is.
SparseMatrix positive_stiffness(const TriangleMesh& mesh) {
    SparseMatrix L = cotangent_stiffness(mesh);
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(L.cols());
    for (Eigen::Index v = 0; v < L.outerSize(); ++v) {
        for (SparseMatrix::InnerIterator it(L, v); it; ++it) {
            if (it.row() == v) continue;
            it.valueRef() = std::min(it.value(), -least_edge_weight);
            sums(v) -= it.value();
        }
    }
    for (Eigen::Index v = 0; v < L.outerSize(); ++v) {
        if (sums(v) > 0) L.coeffRef(v, v) = sums(v);
    }
    return L;
}

// The minimisations for one column after the other.
class Monotonic {
public:
    Monotonic(const WeightProblem& problem, const WeightOptions& options)
        : problem_(problem),
          options_(options),
          edges_(positive_stiffness(problem.mesh)),
          Q_(laplacian_energy(problem)) {
        unknown_.assign(static_cast<std::size_t>(Q_.rows()), 0);
        for (const int v : problem.conditions.vertices) unknown_[static_cast<std::size_t>(v)] = -1;
        for (int v = 0; v < Q_.rows(); ++v) {
            if (unknown_[static_cast<std::size_t>(v)] < 0) continue;
            unknown_[static_cast<std::size_t>(v)] = static_cast<int>(free_.size());
            free_.push_back(v);
        }
        orders_ = unbounded_weights(edges_, problem.conditions);
        if (free_.empty()) return;
        given_ = Eigen::MatrixXd::Zero(Q_.rows(), orders_.cols());
        for (std::size_t i = 0; i < problem.conditions.vertices.size(); ++i) {
            given_.row(problem.conditions.vertices[i]) = problem.conditions.values.row(static_cast<Eigen::Index>(i));
        }
        load_ = Q_ * given_;
        qp_.emplace(free_part());
    }

    WeightSolution solve(Progress& progress) {
        WeightSolution found;
        found.W = orders_;
        if (free_.empty()) return found;
        for (Eigen::Index j = 0; j < orders_.cols(); ++j) {
            progress.step("weights", static_cast<double>(j) / static_cast<double>(orders_.cols()));
            solve(j, found, progress);
        }
        return found;
    }

private:
    SparseMatrix free_part() const {
        std::vector<Eigen::Triplet<double>> entries;
        for (std::size_t i = 0; i < free_.size(); ++i) {
            for (SparseMatrix::InnerIterator it(Q_, free_[i]); it; ++it) {
                const int row = unknown_[static_cast<std::size_t>(it.row())];
                if (row >= 0) entries.emplace_back(row, static_cast<int>(i), it.value());
            }
        }
        const auto size = static_cast<Eigen::Index>(free_.size());
        SparseMatrix part(size, size);
        part.setFromTriplets(entries.begin(), entries.end());
        return part;
    }

    void solve(Eigen::Index j, WeightSolution& found, Progress& progress) const {
        const auto count = static_cast<Eigen::Index>(free_.size());
        Eigen::VectorXd c(count), start(count);
        for (Eigen::Index i = 0; i < count; ++i) {
            c(i) = load_(free_[static_cast<std::size_t>(i)], j);
            start(i) = orders_(free_[static_cast<std::size_t>(i)], j);
        }
        Eigen::VectorXd w = found.W.col(j);
        double residual = 0;
        bool converged = true;
        for (const double tolerance : {std::max(first_tolerance, options_.tolerance), options_.tolerance}) {
            const QpOptions limits{tolerance, options_.max_iterations, [&] {
                                       if (progress.cancelled()) throw Cancelled();
                                   }};
            const std::optional<OrderedQpSolution> solution =
                qp_->solve(c, constraints_by(w, orders_.col(j), j), start, limits);
            if (!solution) {
                throw InvalidInput("mesh",
                                   "its triangles are too thin or too different in size to compute weights with",
                                   "use a mesh with better triangles");
            }
            found.iterations += solution->iterations;
            residual = solution->kkt_residual;
            converged = solution->converged;
            for (Eigen::Index i = 0; i < count; ++i) w(free_[static_cast<std::size_t>(i)]) = solution->x(i);
        }
        found.kkt_residual = std::max(found.kkt_residual, residual);
        found.converged &= converged;
        found.W.col(j) = w.cwiseMax(0).cwiseMin(1);
    }

    // Of each free vertex its least and its greatest neighbour.
    // \param w, u  by which vertices are ordered; by u where w are equal.
    std::vector<OrderConstraint> constraints_by(const Eigen::VectorXd& w, const Eigen::VectorXd& u,
                                                Eigen::Index j) const {
        const auto before = [&](int a, int b) { return std::tie(w(a), u(a), a) < std::tie(w(b), u(b), b); };
        std::vector<OrderConstraint> constraints;
        for (const int v : free_) {
            int least = v, greatest = v;
            for (SparseMatrix::InnerIterator it(edges_, v); it; ++it) {
                const int neighbour = static_cast<int>(it.row());
                if (before(neighbour, least)) least = neighbour;
                if (before(greatest, neighbour)) greatest = neighbour;
            }
            constraints.push_back(order(least == v ? -1 : least, v, j));
            constraints.push_back(order(v, greatest == v ? -1 : greatest, j));
        }
        const auto key = [](const OrderConstraint& each) { return std::tie(each.low, each.high, each.least); };
        std::sort(constraints.begin(), constraints.end(),
                  [&](const OrderConstraint& a, const OrderConstraint& b) { return key(a) < key(b); });
        const auto same = [&](const OrderConstraint& a, const OrderConstraint& b) { return key(a) == key(b); };
        constraints.erase(std::unique(constraints.begin(), constraints.end(), same), constraints.end());
        return constraints;
    }

    // w(low) <= w(high); the vertex -1 has 0 below all and 1 above all.
    OrderConstraint order(int low, int high, Eigen::Index j) const {
        const auto side = [&](int v, double missing) -> std::pair<int, double> {
            if (v < 0) return {-1, missing};
            const int index = unknown_[static_cast<std::size_t>(v)];
            return {index, index < 0 ? given_(v, j) : 0};
        };
        const auto [low_index, low_value] = side(low, 0);
        const auto [high_index, high_value] = side(high, 1);
        return {low_index, high_index, low_value - high_value};
    }

    const WeightProblem& problem_;
    const WeightOptions& options_;
    SparseMatrix edges_;
    SparseMatrix Q_;
    std::vector<int> unknown_;  // #V: index among the free, or -1
    std::vector<int> free_;
    Eigen::MatrixXd orders_;  // functions without extrema
    Eigen::MatrixXd given_;   // #V x #columns, 0 where free
    Eigen::MatrixXd load_;
    std::optional<OrderedQp> qp_;
};

}  // namespace

WeightSolution monotonic_functions(const WeightProblem& problem, const WeightOptions& options, Progress& progress) {
    return Monotonic(problem, options).solve(progress);
}

WeightSolution monotonic_weights(const WeightProblem& problem, const WeightOptions& options, Progress& progress) {
    WeightSolution solution = monotonic_functions(problem, options, progress);
    divide_by_row_sums(problem.mesh, solution.W);
    return solution;
}

}  // namespace puppetwarp
