#include <puppetwarp/mesh/operators.h>

#include <array>
#include <cassert>
#include <cmath>
#include <complex>
#include <vector>

namespace puppetwarp {

namespace {

// Edge vectors from corner k to the two others, and the unsigned double area they span.
struct Corner {
    Eigen::RowVector2d a;
    Eigen::RowVector2d b;
    double double_area;

    double cotangent() const { return a.dot(b) / double_area; }
};

Corner corner_of(const TriangleMesh& mesh, Eigen::Index t, int k) {
    const Eigen::RowVector2d p = mesh.V.row(mesh.F(t, k));
    const Eigen::RowVector2d a = mesh.V.row(mesh.F(t, (k + 1) % 3)) - p;
    const Eigen::RowVector2d b = mesh.V.row(mesh.F(t, (k + 2) % 3)) - p;
    return {a, b, std::abs(a.x() * b.y() - a.y() * b.x())};
}

}  // namespace

SparseMatrix cotangent_stiffness(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness) {
    assert(stiffness.size() == 0 || stiffness.size() == mesh.F.rows());
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(mesh.F.rows() * 6 + mesh.V.rows()));
    Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(mesh.V.rows());
    std::vector<bool> used(static_cast<std::size_t>(mesh.V.rows()));
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        const double factor = stiffness.size() == 0 ? 1.0 : stiffness(t);
        for (int k = 0; k < 3; ++k) {
            const int i = mesh.F(t, (k + 1) % 3);
            const int j = mesh.F(t, (k + 2) % 3);
            const double w = factor * corner_of(mesh, t, k).cotangent() / 2;
            diagonal(i) += w;
            diagonal(j) += w;
            used[static_cast<std::size_t>(i)] = true;
            entries.emplace_back(i, j, -w);
            entries.emplace_back(j, i, -w);
        }
    }
    for (int v = 0; v < mesh.V.rows(); ++v) {
        if (used[static_cast<std::size_t>(v)]) entries.emplace_back(v, v, diagonal(v));
    }
    SparseMatrix L(mesh.V.rows(), mesh.V.rows());
    L.setFromTriplets(entries.begin(), entries.end());
    return L;
}

Eigen::VectorXd lumped_mass(const TriangleMesh& mesh) {
    Eigen::VectorXd M = Eigen::VectorXd::Zero(mesh.V.rows());
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        std::array<Corner, 3> corners;
        int obtuse = -1;
        for (int k = 0; k < 3; ++k) {
            corners[static_cast<std::size_t>(k)] = corner_of(mesh, t, k);
            if (corners[static_cast<std::size_t>(k)].a.dot(corners[static_cast<std::size_t>(k)].b) < 0) obtuse = k;
        }
        const double area = corners[0].double_area / 2;
        for (std::size_t k = 0; k < 3; ++k) {
            double share;
            if (obtuse >= 0) {
                share = static_cast<int>(k) == obtuse ? area / 2 : area / 4;
            } else {
                // Each edge at the corner, weighted by the cotangent of the angle across from it.
                share = (corners[k].a.squaredNorm() * corners[(k + 2) % 3].cotangent() +
                         corners[k].b.squaredNorm() * corners[(k + 1) % 3].cotangent()) /
                        8;
            }
            M(mesh.F(t, static_cast<int>(k))) += share;
        }
    }
    return M;
}

Eigen::MatrixX3cd hat_gradients(const TriangleMesh& mesh) {
    const Eigen::VectorXd areas = double_areas(mesh.V, mesh.F);
    Eigen::MatrixX3cd G(mesh.F.rows(), 3);
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const Eigen::RowVector2d edge = mesh.V.row(mesh.F(t, (k + 2) % 3)) - mesh.V.row(mesh.F(t, (k + 1) % 3));
            // i * edge / double area: the edge turned onto the corner's side. The signed area makes it right for
            // clockwise triangles too.
            G(t, k) = std::complex<double>(-edge.y(), edge.x()) / areas(t);
        }
    }
    return G;
}

}  // namespace puppetwarp
