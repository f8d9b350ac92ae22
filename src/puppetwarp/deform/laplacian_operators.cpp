#include <puppetwarp/deform/laplacian_operators.h>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// Square roots of each row's weight.
Eigen::VectorXd row_factors(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(mesh.V.rows()), count = sum;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        for (int k = 0; k < 3; ++k) {
            sum(mesh.F(t, k)) += stiffness.size() == 0 ? 1.0 : stiffness(t);
            count(mesh.F(t, k)) += 1;
        }
    }
    return (sum.array() / count.array().max(1)).sqrt();
}

}  // namespace

double DifferentialEnergy::operator()(const Eigen::VectorXcd& x) const {
    return (B * x - target).squaredNorm();
}

Eigen::VectorXcd DifferentialEnergy::load(const Eigen::VectorXcd& x) const {
    const Eigen::VectorXcd missing = target - B * x;
    return B.adjoint() * missing;
}

std::vector<std::vector<int>> neighbours_of(const TriangleMesh& mesh) {
    std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(mesh.V.rows()));
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        for (int k = 0; k < 3; ++k) {
            auto& of = neighbours[static_cast<std::size_t>(mesh.F(t, k))];
            of.push_back(mesh.F(t, (k + 1) % 3));
            of.push_back(mesh.F(t, (k + 2) % 3));
        }
    }
    for (std::vector<int>& of : neighbours) {
        std::sort(of.begin(), of.end());
        of.erase(std::unique(of.begin(), of.end()), of.end());
    }
    return neighbours;
}

Eigen::SparseMatrix<double> graph_laplacian(const std::vector<std::vector<int>>& neighbours) {
    const auto n = static_cast<int>(neighbours.size());
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < n; ++i) {
        const std::vector<int>& of = neighbours[static_cast<std::size_t>(i)];
        if (of.empty()) continue;
        entries.emplace_back(i, i, 1.0);
        for (const int j : of) entries.emplace_back(i, j, -1.0 / static_cast<double>(of.size()));
    }
    Eigen::SparseMatrix<double> K(n, n);
    K.setFromTriplets(entries.begin(), entries.end());
    return K;
}

DifferentialEnergy laplacian_energy(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness) {
    const Eigen::VectorXd factor = row_factors(mesh, stiffness);
    const QuadraticForm::Matrix K = graph_laplacian(neighbours_of(mesh)).cast<Complex>();
    DifferentialEnergy energy{factor.cast<Complex>().asDiagonal() * K, {}};
    energy.target = energy.B * complex_positions(mesh.V);
    return energy;
}

DifferentialEnergy similarity_laplacian_energy(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness) {
    const auto neighbours = neighbours_of(mesh);
    const Eigen::VectorXd factor = row_factors(mesh, stiffness);
    const Eigen::VectorXcd rest = complex_positions(mesh.V);
    std::vector<Eigen::Triplet<Complex>> entries;
    for (int i = 0; i < rest.size(); ++i) {
        std::vector<int> ring = neighbours[static_cast<std::size_t>(i)];
        if (ring.empty()) continue;
        const double share = 1 / static_cast<double>(ring.size());
        ring.push_back(i);
        Complex centre = 0;
        for (const int j : ring) centre += rest(j) / static_cast<double>(ring.size());
        Complex delta = 0;
        double size = 0;
        for (const int j : ring) {
            if (j != i) delta += share * (rest(i) - rest(j));
            size += std::norm(rest(j) - centre);
        }
        for (const int j : ring) {
            const Complex turn = std::conj(rest(j) - centre) / size;
            entries.emplace_back(i, j, factor(i) * ((j == i ? 1.0 : -share) - turn * delta));
        }
    }
    QuadraticForm::Matrix B(rest.size(), rest.size());
    B.setFromTriplets(entries.begin(), entries.end());
    return {B, Eigen::VectorXcd::Zero(rest.size())};
}

}  // namespace puppetwarp
