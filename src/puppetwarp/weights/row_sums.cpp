#include <puppetwarp/weights/row_sums.h>

#include <puppetwarp/weights/weight_problem.h>

namespace puppetwarp {

namespace {

// Sums below this are what solvers leave of 0.
constexpr double least_sum = 1e-9;

}  // namespace

void divide_by_row_sums(const TriangleMesh& mesh, Eigen::MatrixXd& W) {
    WeightConditions reached;
    for (Eigen::Index v = 0; v < W.rows(); ++v) {
        if (W.row(v).sum() > least_sum) reached.vertices.push_back(static_cast<int>(v));
    }
    if (static_cast<Eigen::Index>(reached.vertices.size()) < W.rows()) {
        reached.values = W(reached.vertices, Eigen::all);
        reached.values.array().colwise() /= Eigen::VectorXd(reached.values.rowwise().sum()).array();
        W = unbounded_weights(cotangent_stiffness(mesh), reached).cwiseMax(0);
    }
    for (Eigen::Index v = 0; v < W.rows(); ++v) W.row(v) /= W.row(v).sum();
}

}  // namespace puppetwarp
