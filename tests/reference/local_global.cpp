#include "reference/local_global.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include <cmath>
#include <map>

namespace puppetwarp::reference {

namespace {

double cotangent_at(const TriangleMesh& mesh, int apex, int i, int j) {
    const Eigen::Vector2d a = (mesh.V.row(i) - mesh.V.row(apex)).transpose();
    const Eigen::Vector2d b = (mesh.V.row(j) - mesh.V.row(apex)).transpose();
    return 1 / std::tan(std::acos(a.dot(b) / (a.norm() * b.norm())));
}

Eigen::Matrix2d best_rotation(const TriangleMesh& mesh, const std::vector<CellEdge>& cell, const Eigen::MatrixX2d& x) {
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
    for (const CellEdge& e : cell) {
        covariance += e.w * (mesh.V.row(e.j) - mesh.V.row(e.i)).transpose() * (x.row(e.j) - x.row(e.i));
    }
    const Eigen::JacobiSVD<Eigen::Matrix2d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix2d V = svd.matrixV();
    if ((V * svd.matrixU().transpose()).determinant() < 0) V.col(1) *= -1;
    return V * svd.matrixU().transpose();
}

}  // namespace

std::vector<std::vector<CellEdge>> arap_cells(const TriangleMesh& mesh, ArapEnergy energy) {
    const bool elements = energy == ArapEnergy::elements;
    std::vector<std::vector<CellEdge>> cells(static_cast<std::size_t>(elements ? mesh.F.rows() : mesh.V.rows()));
    std::map<std::pair<int, int>, double> edge_weight;
    for (int t = 0; t < mesh.F.rows(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const int apex = mesh.F(t, k), i = mesh.F(t, (k + 1) % 3), j = mesh.F(t, (k + 2) % 3);
            const double w = cotangent_at(mesh, apex, i, j) / 2;
            if (elements) cells[static_cast<std::size_t>(t)].push_back({i, j, w});
            if (energy == ArapEnergy::spokes_and_rims) {
                for (const int centre : {apex, i, j}) cells[static_cast<std::size_t>(centre)].push_back({i, j, w});
            }
            edge_weight[{i, j}] += w;
            edge_weight[{j, i}] += w;
        }
    }
    if (energy == ArapEnergy::spokes) {
        for (const auto& [ends, w] : edge_weight) {
            cells[static_cast<std::size_t>(ends.first)].push_back({ends.first, ends.second, w});
        }
    }
    return cells;
}

double arap_energy(const TriangleMesh& mesh, ArapEnergy energy, const Eigen::MatrixX2d& x) {
    double sum = 0;
    for (const auto& cell : arap_cells(mesh, energy)) {
        const Eigen::Matrix2d R = best_rotation(mesh, cell, x);
        for (const CellEdge& e : cell) {
            const Eigen::Vector2d rest = (mesh.V.row(e.j) - mesh.V.row(e.i)).transpose();
            sum += e.w * ((x.row(e.j) - x.row(e.i)).transpose() - R * rest).squaredNorm();
        }
    }
    return sum;
}

Eigen::MatrixX2d local_global(const TriangleMesh& mesh, ArapEnergy energy, const std::vector<int>& held,
                              const Eigen::MatrixX2d& start, double step, int iterations) {
    const auto n = static_cast<int>(mesh.V.rows());
    const auto cells = arap_cells(mesh, energy);
    std::vector<bool> is_held(static_cast<std::size_t>(n));
    for (const int v : held) is_held[static_cast<std::size_t>(v)] = true;

    // Rows of held vertices say x = start; the others that the energy does not change with x.
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](int row, int column, double value) {
        if (!is_held[static_cast<std::size_t>(row)]) entries.emplace_back(row, column, value);
    };
    for (const auto& cell : cells) {
        for (const CellEdge& e : cell) {
            add(e.i, e.i, e.w);
            add(e.i, e.j, -e.w);
            add(e.j, e.j, e.w);
            add(e.j, e.i, -e.w);
        }
    }
    // Held columns go to the right-hand side, so that the matrix stays symmetric.
    std::vector<Eigen::Triplet<double>> free_entries, held_entries;
    for (const auto& entry : entries) {
        (is_held[static_cast<std::size_t>(entry.col())] ? held_entries : free_entries).push_back(entry);
    }
    for (const int v : held) free_entries.emplace_back(v, v, 1.0);
    Eigen::SparseMatrix<double> A(n, n), B(n, n);
    A.setFromTriplets(free_entries.begin(), free_entries.end());
    B.setFromTriplets(held_entries.begin(), held_entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(A);

    Eigen::MatrixX2d x = start;
    for (int iteration = 0; iteration < iterations; ++iteration) {
        Eigen::MatrixX2d b = Eigen::MatrixX2d::Zero(n, 2);
        for (const auto& cell : cells) {
            const Eigen::Matrix2d R = best_rotation(mesh, cell, x);
            for (const CellEdge& e : cell) {
                const Eigen::RowVector2d pull = e.w * (mesh.V.row(e.j) - mesh.V.row(e.i)) * R.transpose();
                b.row(e.j) += pull;
                b.row(e.i) -= pull;
            }
        }
        b -= B * start;
        for (const int v : held) b.row(v) = start.row(v);
        const Eigen::MatrixX2d next = solver.solve(b);
        const double change = (next - x).cwiseAbs().maxCoeff();
        x = next;
        if (change <= step) break;
    }
    return x;
}

}  // namespace puppetwarp::reference
