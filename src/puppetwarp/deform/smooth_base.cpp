#include <puppetwarp/deform/smooth_base.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/operators.h>
#include <puppetwarp/rig/binding.h>
#include <puppetwarp/solve/cholesky.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

constexpr double largest_share = 1.0 / 3;

// Vertices of the outline, and their neighbours along it.
using Outlines = std::map<int, std::vector<int>>;

Outlines outlines_of(const TriangleMesh& mesh) {
    std::map<std::pair<int, int>, int> count;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const int i = mesh.F(t, k), j = mesh.F(t, (k + 1) % 3);
            ++count[{std::min(i, j), std::max(i, j)}];
        }
    }
    Outlines outlines;
    for (const auto& [ends, triangles] : count) {
        if (triangles != 1) continue;
        outlines[ends.first].push_back(ends.second);
        outlines[ends.second].push_back(ends.first);
    }
    return outlines;
}

// The length of the loop that each vertex of the outline lies on.
std::map<int, double> loop_lengths(const Outlines& outlines, const Eigen::VectorXcd& rest) {
    std::map<int, double> lengths;
    for (const auto& [start, unused] : outlines) {
        if (lengths.contains(start)) continue;
        std::vector<int> loop{start};
        lengths[start] = 0;
        double twice = 0;
        for (std::size_t next = 0; next < loop.size(); ++next) {
            for (const int j : outlines.at(loop[next])) {
                twice += std::abs(rest(j) - rest(loop[next]));
                if (lengths.emplace(j, 0).second) loop.push_back(j);
            }
        }
        for (const int v : loop) lengths[v] = twice / 2;
    }
    return lengths;
}

Eigen::VectorXcd solved(const std::vector<Eigen::Triplet<double>>& lower_entries, Eigen::VectorXcd b) {
    if (b.size() == 0) return b;
    Eigen::SparseMatrix<double> lower(b.size(), b.size());
    lower.setFromTriplets(lower_entries.begin(), lower_entries.end());
    const auto factor = CholeskyPattern(lower).factorise(lower);
    if (!factor) {
        throw InvalidInput("mesh", "its triangles are too thin or too different in size to compute with",
                           "use a mesh with better triangles");
    }
    factor->solve_in_place(b);
    return b;
}

// Of the vertices of the outline, in their order: (S + l^4 D^T S D) detail = l^4 D^T S D p, with D the second
// derivative by arc length and S the length at each vertex.
Eigen::VectorXcd outline_detail(const Outlines& outlines, const Eigen::VectorXcd& rest, double length_px) {
    const std::map<int, double> loop = loop_lengths(outlines, rest);
    std::map<int, int> slot;
    for (const auto& [v, unused] : outlines) slot.emplace(v, static_cast<int>(slot.size()));
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXcd b = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(slot.size()));
    for (const auto& [v, neighbours] : outlines) {
        double length = 0;
        for (const int j : neighbours) length += std::abs(rest(j) - rest(v)) / 2;
        entries.emplace_back(slot[v], slot[v], length);
        if (neighbours.size() != 2) continue;
        const double before = std::abs(rest(neighbours[0]) - rest(v)), after = std::abs(rest(neighbours[1]) - rest(v));
        const double limit = largest_share * loop.at(v) / (2 * std::numbers::pi);
        const double weight = length * std::pow(std::min(length_px, limit), 4);
        const int at[3] = {slot[neighbours[0]], slot[v], slot[neighbours[1]]};
        const double row[3] = {1 / (before * length), -1 / (before * length) - 1 / (after * length),
                               1 / (after * length)};
        const Complex bend = row[0] * (rest(neighbours[0]) - rest(v)) + row[2] * (rest(neighbours[1]) - rest(v));
        for (int i = 0; i < 3; ++i) {
            b(at[i]) += weight * row[i] * bend;
            for (int j = 0; j < 3; ++j) {
                if (at[i] >= at[j]) entries.emplace_back(at[i], at[j], weight * row[i] * row[j]);
            }
        }
    }
    return solved(entries, b);
}

}  // namespace

Eigen::VectorXcd detail_over_smooth_base(const TriangleMesh& mesh, double length_px) {
    const Outlines outlines = outlines_of(mesh);
    const Eigen::VectorXcd along = outline_detail(outlines, complex_positions(mesh.V), length_px);
    Eigen::VectorXcd detail = Eigen::VectorXcd::Zero(mesh.V.rows());
    Eigen::Index next = 0;
    for (const auto& [v, unused] : outlines) detail(v) = along(next++);

    const SparseMatrix L = cotangent_stiffness(mesh);
    std::vector<int> slot(static_cast<std::size_t>(mesh.V.rows()), -1), inside;
    for (int v = 0; v < mesh.V.rows(); ++v) {
        // A vertex of no triangle is in nobody's inside.
        if (outlines.contains(v) || L.coeff(v, v) == 0) continue;
        slot[static_cast<std::size_t>(v)] = static_cast<int>(inside.size());
        inside.push_back(v);
    }
    std::vector<Eigen::Triplet<double>> entries;
    for (const int v : inside) {
        const int column = slot[static_cast<std::size_t>(v)];
        for (SparseMatrix::InnerIterator it(L, v); it; ++it) {
            const int row = slot[static_cast<std::size_t>(it.row())];
            if (row >= column) entries.emplace_back(row, column, it.value());
        }
    }
    const Eigen::VectorXcd pull = L * detail;
    detail(inside) = solved(entries, -pull(inside));
    return detail;
}

}  // namespace puppetwarp
