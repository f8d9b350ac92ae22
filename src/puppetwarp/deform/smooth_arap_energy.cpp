#include <puppetwarp/deform/smooth_arap_energy.h>

#include <puppetwarp/deform/element_energy.h>

#include <cmath>
#include <map>
#include <utility>

namespace puppetwarp {

namespace {

// 1 for vertices with triangles all around, 0 on the border and for vertices of no triangle.
Eigen::VectorXd inner_vertices(const TriangleMesh& mesh) {
    std::map<std::pair<int, int>, int> triangles;
    Eigen::VectorXd inner = Eigen::VectorXd::Zero(mesh.V.rows());
    for (int t = 0; t < mesh.F.rows(); ++t) {
        for (int k = 0; k < 3; ++k) {
            inner(mesh.F(t, k)) = 1;
            const auto [low, high] = std::minmax(mesh.F(t, k), mesh.F(t, (k + 1) % 3));
            ++triangles[{low, high}];
        }
    }
    for (const auto& [edge, count] : triangles) {
        if (count == 1) inner(edge.first) = inner(edge.second) = 0;
    }
    return inner;
}

}  // namespace

SmoothArapEnergy::SmoothArapEnergy(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness, double bending_length_px)
    : arap_(make_element_arap(mesh, stiffness)) {
    Eigen::VectorXd factor = inner_vertices(mesh);
    const Eigen::VectorXd mass = lumped_mass(mesh);
    for (Eigen::Index v = 0; v < factor.size(); ++v) {
        if (factor(v) > 0) factor(v) = bending_length_px / std::sqrt(mass(v));
    }
    scaled_ = factor.asDiagonal() * cotangent_stiffness(mesh);
    bending_ = 2 * SparseMatrix(scaled_.transpose() * scaled_);
    constant_ = arap_->constant_hessian() + bending_;
}

// Seen from a vertex: rows sum to 0, and far from the origin that would cost digits.
Eigen::VectorXcd SmoothArapEnergy::curvature(const Eigen::VectorXcd& x) const {
    return scaled_ * (x.array() - x(0)).matrix();
}

double SmoothArapEnergy::value(const Eigen::VectorXcd& x) const {
    return arap_->value(x) + curvature(x).squaredNorm();
}

double SmoothArapEnergy::gradient(const Eigen::VectorXcd& x, Eigen::VectorXcd& g) const {
    const double arap = arap_->gradient(x, g);
    const Eigen::VectorXcd bent = curvature(x);
    g += 2 * (scaled_.transpose() * bent);
    return arap + bent.squaredNorm();
}

}  // namespace puppetwarp
