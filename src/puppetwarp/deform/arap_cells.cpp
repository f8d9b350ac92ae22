#include <puppetwarp/deform/arap_cells.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;
using Edge = ArapCells::Edge;

// Half the cotangent of each corner, as the weight of the edge across from it.
std::vector<std::array<Edge, 3>> triangle_edges(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness) {
    std::vector<std::array<Edge, 3>> edges(static_cast<std::size_t>(mesh.F.rows()));
    for (int t = 0; t < mesh.F.rows(); ++t) {
        const double factor = stiffness.size() == 0 ? 1.0 : stiffness(t);
        for (int k = 0; k < 3; ++k) {
            const int apex = mesh.F(t, k);
            const int i = mesh.F(t, (k + 1) % 3);
            const int j = mesh.F(t, (k + 2) % 3);
            const Eigen::RowVector2d a = mesh.V.row(i) - mesh.V.row(apex);
            const Eigen::RowVector2d b = mesh.V.row(j) - mesh.V.row(apex);
            const double cotangent = a.dot(b) / std::abs(a.x() * b.y() - a.y() * b.x());
            const Eigen::RowVector2d rest = mesh.V.row(j) - mesh.V.row(i);
            edges[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)] = {i, j, factor * cotangent / 2,
                                                                               Complex(rest.x(), rest.y())};
        }
    }
    return edges;
}

using Cells = std::vector<std::vector<Edge>>;

Cells spoke_cells(const TriangleMesh& mesh, const std::vector<std::array<Edge, 3>>& triangles) {
    // Both triangles of an edge add to its weight; ordered, so that every run sums in the same order.
    std::map<std::pair<int, int>, Edge> whole;
    for (const auto& edges : triangles) {
        for (Edge edge : edges) {
            if (edge.i > edge.j) edge = {edge.j, edge.i, edge.w, -edge.rest};
            const auto [place, fresh] = whole.try_emplace({edge.i, edge.j}, edge);
            if (!fresh) place->second.w += edge.w;
        }
    }
    Cells cells(static_cast<std::size_t>(mesh.V.rows()));
    for (const auto& [ends, edge] : whole) {
        cells[static_cast<std::size_t>(edge.i)].push_back(edge);
        cells[static_cast<std::size_t>(edge.j)].push_back(edge);
    }
    return cells;
}

Cells spoke_and_rim_cells(const TriangleMesh& mesh, const std::vector<std::array<Edge, 3>>& triangles) {
    Cells cells(static_cast<std::size_t>(mesh.V.rows()));
    for (int t = 0; t < mesh.F.rows(); ++t) {
        const auto& edges = triangles[static_cast<std::size_t>(t)];
        for (int k = 0; k < 3; ++k) {
            auto& cell = cells[static_cast<std::size_t>(mesh.F(t, k))];
            cell.insert(cell.end(), edges.begin(), edges.end());
        }
    }
    return cells;
}

Complex direction_of(const Complex& z) {
    const double length = std::abs(z);
    return length > 0 ? z / length : Complex(1);
}

}  // namespace

ArapCells::ArapCells(const TriangleMesh& mesh, ArapEnergy energy, const Eigen::VectorXd& stiffness)
    : first_edge_{0}, first_vertex_{0}, twice_K_(mesh.V.rows(), mesh.V.rows()) {
    const auto triangles = triangle_edges(mesh, stiffness);
    std::vector<Eigen::Triplet<double>> entries;
    for (const std::vector<Edge>& cell :
         energy == ArapEnergy::spokes ? spoke_cells(mesh, triangles) : spoke_and_rim_cells(mesh, triangles)) {
        // S_c x = sum of w conj(rest) (x_j - x_i); its direction is the closest rotation.
        std::map<int, Complex> functional;
        double rest_correlation = 0;
        for (const Edge& edge : cell) {
            functional[edge.i] -= edge.w * std::conj(edge.rest);
            functional[edge.j] += edge.w * std::conj(edge.rest);
            rest_correlation += edge.w * std::norm(edge.rest);
            entries.emplace_back(edge.i, edge.i, 2 * edge.w);
            entries.emplace_back(edge.j, edge.j, 2 * edge.w);
            entries.emplace_back(edge.i, edge.j, -2 * edge.w);
            entries.emplace_back(edge.j, edge.i, -2 * edge.w);
        }
        edges_.insert(edges_.end(), cell.begin(), cell.end());
        first_edge_.push_back(static_cast<int>(edges_.size()));
        for (const auto& [vertex, coefficient] : functional) {
            cell_vertices_.push_back(vertex);
            functional_.push_back(coefficient);
        }
        first_vertex_.push_back(static_cast<int>(cell_vertices_.size()));
        rest_correlation_.push_back(std::abs(rest_correlation));
    }
    twice_K_.setFromTriplets(entries.begin(), entries.end());
}

// Edges are taken as differences first: near rest the energy is a small remainder, and must be one of small numbers.
Complex ArapCells::correlation(int cell, const Eigen::VectorXcd& x) const {
    double re = 0, im = 0;
    for (int e = first_edge_[static_cast<std::size_t>(cell)]; e < first_edge_[static_cast<std::size_t>(cell) + 1];
         ++e) {
        const Edge& edge = edges_[static_cast<std::size_t>(e)];
        const Complex now = x(edge.j) - x(edge.i);
        re += edge.w * (edge.rest.real() * now.real() + edge.rest.imag() * now.imag());
        im += edge.w * (edge.rest.real() * now.imag() - edge.rest.imag() * now.real());
    }
    return {re, im};
}

double ArapCells::value(const Eigen::VectorXcd& x) const {
    double energy = 0;
    for (int cell = 0; cell < cells(); ++cell) {
        const Complex r = direction_of(correlation(cell, x));
        for (int e = first_edge_[static_cast<std::size_t>(cell)]; e < first_edge_[static_cast<std::size_t>(cell) + 1];
             ++e) {
            const Edge& edge = edges_[static_cast<std::size_t>(e)];
            const double re = r.real() * edge.rest.real() - r.imag() * edge.rest.imag();
            const double im = r.real() * edge.rest.imag() + r.imag() * edge.rest.real();
            energy += edge.w * std::norm(x(edge.j) - x(edge.i) - Complex(re, im));
        }
    }
    return energy;
}

double ArapCells::gradient(const Eigen::VectorXcd& x, Eigen::VectorXcd& g) const {
    g.setZero(x.size());
    double energy = 0;
    for (int cell = 0; cell < cells(); ++cell) {
        const Complex r = direction_of(correlation(cell, x));
        for (int e = first_edge_[static_cast<std::size_t>(cell)]; e < first_edge_[static_cast<std::size_t>(cell) + 1];
             ++e) {
            const Edge& edge = edges_[static_cast<std::size_t>(e)];
            const double re = r.real() * edge.rest.real() - r.imag() * edge.rest.imag();
            const double im = r.real() * edge.rest.imag() + r.imag() * edge.rest.real();
            const Complex off = x(edge.j) - x(edge.i) - Complex(re, im);
            energy += edge.w * std::norm(off);
            // The rotation is the best one, so that its own change does not count.
            g(edge.j) += 2 * edge.w * off;
            g(edge.i) -= 2 * edge.w * off;
        }
    }
    return energy;
}

std::span<const int> ArapCells::vertices(int cell) const {
    const int first = first_vertex_[static_cast<std::size_t>(cell)];
    const int end = first_vertex_[static_cast<std::size_t>(cell) + 1];
    return {cell_vertices_.data() + first, static_cast<std::size_t>(end - first)};
}

void ArapCells::cell_hessian(int cell, const Eigen::VectorXcd& x, HessianKind kind, double* lower) const {
    const Complex z = correlation(cell, x);
    const double rest = rest_correlation_[static_cast<std::size_t>(cell)];
    // A cell whose rotation is undefined has a cusp there; far enough from it the weight is the true one.
    double length = std::max(std::abs(z), 1e-9 * rest);
    if (kind == HessianKind::clamped) length = std::max(length, rest);
    const double weight = length > 0 ? 2 / length : 0;
    const Complex r = direction_of(z);
    const int first = first_vertex_[static_cast<std::size_t>(cell)];
    const int count = 2 * (first_vertex_[static_cast<std::size_t>(cell) + 1] - first);
    // Im(conj(r) s x) as a row over (Re x, Im x).
    const auto entry = [&](int k) {
        const Complex s = std::conj(r) * functional_[static_cast<std::size_t>(first) + static_cast<std::size_t>(k / 2)];
        return k % 2 == 0 ? s.imag() : s.real();
    };
    for (int i = 0; i < count; ++i) {
        for (int j = 0; j <= i; ++j) *lower++ = -weight * entry(i) * entry(j);
    }
}

}  // namespace puppetwarp
