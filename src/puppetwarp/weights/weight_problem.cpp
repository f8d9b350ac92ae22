#include <puppetwarp/weights/weight_problem.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/rig/binding.h>
#include <puppetwarp/solve/supernodal_cholesky.h>
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

Eigen::MatrixXd unbounded_weights(const SparseMatrix& Q, const WeightConditions& conditions) {
    const Eigen::Index n = Q.rows();
    std::vector<bool> given(static_cast<std::size_t>(n));
    for (const int v : conditions.vertices) given[static_cast<std::size_t>(v)] = true;
    const auto is_given = [&](Eigen::Index v) { return given[static_cast<std::size_t>(v)]; };

    // What is given are equations of one unknown each, and goes into the others' right-hand sides.
    SparseMatrix lower(n, n);
    lower.reserve((Q.nonZeros() + n) / 2);
    for (int column = 0; column < n; ++column) {
        lower.startVec(column);
        if (is_given(column)) lower.insertBack(column, column) = 1;
        for (SparseMatrix::InnerIterator it(Q, column); it; ++it) {
            if (it.row() < column || is_given(column) || is_given(it.row())) continue;
            lower.insertBack(it.row(), column) = it.value();
        }
    }
    lower.finalize();
    RowMatrix W = RowMatrix::Zero(n, conditions.values.cols());
    for (std::size_t i = 0; i < conditions.vertices.size(); ++i) {
        const int v = conditions.vertices[i];
        for (Eigen::Index c = 0; c < W.cols(); ++c) {
            const double value = conditions.values(static_cast<Eigen::Index>(i), c);
            if (value == 0) continue;
            W(v, c) = value;
            for (SparseMatrix::InnerIterator it(Q, v); it; ++it) {
                if (!is_given(it.row())) W(it.row(), c) -= it.value() * value;
            }
        }
    }
    const std::optional<SupernodalCholesky> factor = SupernodalCholesky::factorise(lower);
    if (!factor) {
        throw InvalidInput("mesh", "its triangles are too thin or too different in size to compute weights with",
                           "use a mesh with better triangles");
    }
    factor->solve_in_place(W);
    return W;
}

}  // namespace puppetwarp
