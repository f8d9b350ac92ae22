#include <puppetwarp/mesh/triangle_mesh.h>

#include <puppetwarp/base/errors.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace puppetwarp {

namespace {

// A triangle is of no area when its height is this share of its longest edge: below, cotangents are round-off.
constexpr double smallest_height = 1e-10;

double longest_squared_edge(const TriangleMesh& mesh, int t) {
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
        longest = std::max(longest, (mesh.V.row(mesh.F(t, (k + 1) % 3)) - mesh.V.row(mesh.F(t, k))).squaredNorm());
    }
    return longest;
}

// Lowest member of the set that holds i; halves the path on the way.
int find_root(std::vector<int>& parent, int i) {
    while (parent[static_cast<std::size_t>(i)] != i) {
        int& up = parent[static_cast<std::size_t>(i)];
        up = parent[static_cast<std::size_t>(up)];
        i = up;
    }
    return i;
}

void require_finite(const TriangleMesh& mesh, const char* subject) {
    for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
        if (!mesh.V.row(v).allFinite()) {
            throw InvalidInput(subject,
                               "vertex " + std::to_string(v) + " has a coordinate that is not a finite number");
        }
    }
}

void require_indices(const TriangleMesh& mesh, const char* subject) {
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const int v = mesh.F(t, k);
            if (v >= 0 && v < mesh.V.rows()) continue;
            throw InvalidInput(subject, "triangle " + std::to_string(t) + " names vertex " + std::to_string(v) +
                                            ", but the mesh has " + std::to_string(mesh.V.rows()) + " vertices");
        }
    }
}

void require_areas(const TriangleMesh& mesh, const char* subject) {
    const Eigen::VectorXd areas = double_areas(mesh.V, mesh.F);
    for (int t = 0; t < areas.size(); ++t) {
        // Written so that areas which overflowed fail too.
        if (std::isfinite(areas(t)) && std::abs(areas(t)) > smallest_height * longest_squared_edge(mesh, t)) continue;
        throw InvalidInput(subject, "triangle " + std::to_string(t) + " has no area", "remove or repair it");
    }
    // Of both orientations, the rarer one is folded over.
    const Eigen::Index positive = (areas.array() > 0).count();
    if (positive == 0 || positive == areas.size()) return;
    const bool folded = 2 * positive <= areas.size();
    for (int t = 0; t < areas.size(); ++t) {
        if ((areas(t) > 0) != folded) continue;
        throw InvalidInput(
            subject,
            "triangle " + std::to_string(t) + " is turned against the others: folded over, or of another orientation",
            "unfold the mesh, and orient all triangles the same way");
    }
}

// Triangles of one orientation pass each edge at most once in each direction, unless they lie over each other.
void require_manifold_edges(const TriangleMesh& mesh, const char* subject) {
    struct HalfEdge {
        int to;
        int triangle;
    };
    // Sorted by their first vertex through counting.
    std::vector<std::size_t> begin(static_cast<std::size_t>(mesh.V.rows()) + 1);
    for (const int v : mesh.F.reshaped()) ++begin[static_cast<std::size_t>(v) + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
    std::vector<HalfEdge> edges(static_cast<std::size_t>(mesh.F.size()));
    for (int t = 0; t < mesh.F.rows(); ++t) {
        for (int k = 0; k < 3; ++k) {
            edges[next[static_cast<std::size_t>(mesh.F(t, k))]++] = {mesh.F(t, (k + 1) % 3), t};
        }
    }
    for (std::size_t v = 0; v + 1 < begin.size(); ++v) {
        const auto first = edges.begin() + static_cast<std::ptrdiff_t>(begin[v]);
        const auto last = edges.begin() + static_cast<std::ptrdiff_t>(begin[v + 1]);
        std::sort(first, last, [](const HalfEdge& a, const HalfEdge& b) {
            return std::pair(a.to, a.triangle) < std::pair(b.to, b.triangle);
        });
        const auto twice = std::adjacent_find(first, last, [](const auto& a, const auto& b) { return a.to == b.to; });
        if (twice == last) continue;
        throw InvalidInput(subject,
                           "triangles " + std::to_string(twice->triangle) + " and " +
                               std::to_string((twice + 1)->triangle) + " lie on one side of the edge from vertex " +
                               std::to_string(v) + " to " + std::to_string(twice->to),
                           "an edge belongs to two triangles at most, one on each side");
    }
}

}  // namespace

Eigen::VectorXd double_areas(const Eigen::MatrixX2d& V, const Eigen::MatrixX3i& F) {
    Eigen::VectorXd areas(F.rows());
    for (Eigen::Index t = 0; t < F.rows(); ++t) {
        const Eigen::RowVector2d a = V.row(F(t, 1)) - V.row(F(t, 0));
        const Eigen::RowVector2d b = V.row(F(t, 2)) - V.row(F(t, 0));
        areas(t) = a.x() * b.y() - a.y() * b.x();
    }
    return areas;
}

double bounding_diagonal(const Eigen::MatrixX2d& V) {
    if (V.rows() == 0) return 0;
    return (V.colwise().maxCoeff() - V.colwise().minCoeff()).norm();
}

Eigen::VectorXi vertex_components(const TriangleMesh& mesh) {
    const int n = static_cast<int>(mesh.V.rows());
    std::vector<int> parent(static_cast<std::size_t>(n));
    std::iota(parent.begin(), parent.end(), 0);
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        for (int k = 0; k < 2; ++k) {
            const int a = find_root(parent, mesh.F(t, k));
            const int b = find_root(parent, mesh.F(t, k + 1));
            parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
        }
    }
    // The root is the lowest index of its component, so it is met first.
    Eigen::VectorXi component(n);
    int count = 0;
    for (int v = 0; v < n; ++v) {
        const int root = find_root(parent, v);
        component(v) = root == v ? count++ : component(root);
    }
    return component;
}

void require_sound(const TriangleMesh& mesh, const char* subject) {
    if (mesh.F.rows() == 0) throw InvalidInput(subject, "the mesh has no triangles");
    require_finite(mesh, subject);
    require_indices(mesh, subject);
    require_areas(mesh, subject);
    require_manifold_edges(mesh, subject);
}

}  // namespace puppetwarp
