#include "reference/dense_field.h"

#include <Eigen/LU>

#include <cmath>

namespace puppetwarp::reference {

namespace {

using Long = long double;
using LongMatrix = Eigen::Matrix<Long, Eigen::Dynamic, Eigen::Dynamic>;
using LongComplexMatrix = Eigen::Matrix<std::complex<Long>, Eigen::Dynamic, Eigen::Dynamic>;
using LongVector = Eigen::Matrix<Long, 2, 1>;

struct Operators {
    LongMatrix L;
    LongMatrix M;
};

// Integrals of products of hat functions' gradients, and mixed Voronoi areas (Meyer et al. 2003).
Operators operators_of(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness) {
    const Eigen::Index n = mesh.V.rows();
    Operators result{LongMatrix::Zero(n, n), LongMatrix::Zero(n, n)};
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        LongVector p[3], gradient[3];
        for (int k = 0; k < 3; ++k) p[k] = mesh.V.row(mesh.F(t, k)).transpose().cast<Long>();
        const Long doubled = (p[1] - p[0]).x() * (p[2] - p[0]).y() - (p[1] - p[0]).y() * (p[2] - p[0]).x();
        const Long area = std::abs(doubled) / 2;
        int obtuse = -1;
        for (int k = 0; k < 3; ++k) {
            const LongVector across = p[(k + 2) % 3] - p[(k + 1) % 3];
            gradient[k] = LongVector(-across.y(), across.x()) / doubled;
            if ((p[(k + 1) % 3] - p[k]).dot(p[(k + 2) % 3] - p[k]) < 0) obtuse = k;
        }
        const Long factor = stiffness.size() == 0 ? 1 : static_cast<Long>(stiffness(t));
        for (int k = 0; k < 3; ++k) {
            const int v = mesh.F(t, k);
            for (int j = 0; j < 3; ++j) result.L(v, mesh.F(t, j)) += factor * area * gradient[k].dot(gradient[j]);
            // The Voronoi cell within the triangle: a quarter of each edge's square over the tangent across.
            Long voronoi = 0;
            for (int j = 1; j < 3; ++j) {
                const int other = (k + j) % 3;
                const Long cotangent = -gradient[k].dot(gradient[other]) * 2 * area;
                voronoi += (p[k] - p[other]).squaredNorm() * cotangent / 8;
            }
            result.M(v, v) += obtuse < 0 ? voronoi : (obtuse == k ? area / 2 : area / 4);
        }
    }
    return result;
}

}  // namespace

Eigen::VectorXcd dense_field(const TriangleMesh& mesh, const DenseEnergy& energy,
                             const std::vector<DenseConstraint>& constraints) {
    const Eigen::Index n = mesh.V.rows(), levels = energy.order * n;
    const auto m = static_cast<Eigen::Index>(constraints.size());
    const Operators plain = operators_of(mesh, {});
    const LongMatrix K = operators_of(mesh, energy.stiffness).L;
    // M w_j = L w_(j-1); weight L w_(order-1) + first_order K w_0 + C^H lambda = 0; C w_0 = d.
    LongComplexMatrix A = LongComplexMatrix::Zero(levels + m, levels + m);
    LongComplexMatrix b = LongComplexMatrix::Zero(levels + m, 1);
    for (int j = 1; j < energy.order; ++j) {
        A.block(j * n, (j - 1) * n, n, n) = plain.L.cast<std::complex<Long>>();
        A.block(j * n, j * n, n, n) = -plain.M.cast<std::complex<Long>>();
    }
    const LongMatrix& last = energy.order == 1 ? K : plain.L;
    A.block(0, (energy.order - 1) * n, n, n) += static_cast<Long>(energy.weight) * last.cast<std::complex<Long>>();
    A.topLeftCorner(n, n) += static_cast<Long>(energy.first_order) * K.cast<std::complex<Long>>();
    for (Eigen::Index i = 0; i < m; ++i) {
        const DenseConstraint& constraint = constraints[static_cast<std::size_t>(i)];
        for (const auto& [vertex, coefficient] : constraint.row) {
            A(levels + i, vertex) += std::complex<Long>(coefficient);
            A(vertex, levels + i) += std::conj(std::complex<Long>(coefficient));
        }
        b(levels + i, 0) = std::complex<Long>(constraint.value);
    }
    const LongComplexMatrix u = A.partialPivLu().solve(b).topRows(n);
    return u.cast<std::complex<double>>();
}

}  // namespace puppetwarp::reference
