#include <puppetwarp/weights/weight_problem.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/rig/binding.h>
#include <puppetwarp/solve/cholesky.h>
#include <puppetwarp/weights/weight_conditions.h>

#include <optional>
#include <utility>

namespace puppetwarp {

WeightProblem::WeightProblem(const TriangleMesh& domain, const Rig& all)
    : WeightProblem(domain, all, weight_conditions(domain, all)) {}

WeightProblem::WeightProblem(const TriangleMesh& domain, const Rig& all, WeightConditions given)
    : mesh(domain), rig(all), stiffness(triangle_stiffness(mesh, rig.stiffness)), conditions(std::move(given)) {}

std::vector<WeightColumn> weight_columns(const Rig& rig) {
    std::vector<WeightColumn> columns;
    for (std::size_t h = 0; h < rig.handles.size(); ++h) {
        const auto handle = static_cast<int>(h);
        const auto* cage = std::get_if<CageHandle>(&rig.handles[h].shape);
        if (cage == nullptr) {
            columns.push_back({handle, -1});
        } else {
            for (std::size_t k = 0; k < cage->points.size(); ++k) columns.push_back({handle, static_cast<int>(k)});
        }
    }
    return columns;
}

SparseMatrix laplacian_energy(const WeightProblem& problem) {
    const double diagonal = bounding_diagonal(problem.mesh.V);
    const SparseMatrix L = cotangent_stiffness(problem.mesh);
    // A vertex of no triangle has no mass, and its row of L is 0.
    const Eigen::VectorXd scale =
        lumped_mass(problem.mesh).unaryExpr([&](double m) { return m > 0 ? diagonal * diagonal / m : 0; });
    SparseMatrix Q = SparseMatrix(L * scale.asDiagonal()) * L;
    if (problem.stiffness.size() > 0) {
        const Eigen::VectorXd rho = (problem.stiffness.array() - 1).max(0);
        Q += cotangent_stiffness(problem.mesh, rho);
    }
    return Q;
}

namespace {

// \param entries  of the lower triangle of a positive definite matrix.
void solve_in_place(const std::vector<Eigen::Triplet<double>>& entries, Eigen::MatrixXd& X) {
    if (X.rows() == 0) return;
    SparseMatrix lower(X.rows(), X.rows());
    lower.setFromTriplets(entries.begin(), entries.end());
    const std::optional<CholeskyFactor> factor = CholeskyPattern(lower).factorise(lower);
    if (!factor) {
        throw InvalidInput("mesh", "its triangles are too thin or too different in size to compute weights with",
                           "use a mesh with better triangles");
    }
    factor->solve_in_place(X);
}

}  // namespace

Eigen::MatrixXd unbounded_weights(const SparseMatrix& Q, const WeightConditions& conditions) {
    const Eigen::Index n = Q.rows();
    std::vector<int> unknown(static_cast<std::size_t>(n), 0);
    for (const int v : conditions.vertices) unknown[static_cast<std::size_t>(v)] = -1;
    std::vector<int> free;
    for (int v = 0; v < n; ++v) {
        int& index = unknown[static_cast<std::size_t>(v)];
        if (index < 0) continue;
        index = static_cast<int>(free.size());
        free.push_back(v);
    }
    std::vector<Eigen::Triplet<double>> entries;
    for (const int v : free) {
        const int column = unknown[static_cast<std::size_t>(v)];
        for (SparseMatrix::InnerIterator it(Q, v); it; ++it) {
            const int row = unknown[static_cast<std::size_t>(it.row())];
            if (row >= column) entries.emplace_back(row, column, it.value());
        }
    }
    const auto size = static_cast<Eigen::Index>(free.size());
    Eigen::MatrixXd X = Eigen::MatrixXd::Zero(size, conditions.values.cols());
    for (std::size_t i = 0; i < conditions.vertices.size(); ++i) {
        const auto given = conditions.values.row(static_cast<Eigen::Index>(i));
        for (Eigen::Index c = 0; c < given.size(); ++c) {
            if (given(c) == 0) continue;
            for (SparseMatrix::InnerIterator it(Q, conditions.vertices[i]); it; ++it) {
                const int row = unknown[static_cast<std::size_t>(it.row())];
                if (row >= 0) X(row, c) -= it.value() * given(c);
            }
        }
    }
    solve_in_place(entries, X);
    Eigen::MatrixXd W(n, X.cols());
    for (std::size_t i = 0; i < conditions.vertices.size(); ++i) {
        W.row(conditions.vertices[i]) = conditions.values.row(static_cast<Eigen::Index>(i));
    }
    for (Eigen::Index c = 0; c < X.cols(); ++c) {
        for (Eigen::Index i = 0; i < size; ++i) W(free[static_cast<std::size_t>(i)], c) = X(i, c);
    }
    return W;
}

}  // namespace puppetwarp
