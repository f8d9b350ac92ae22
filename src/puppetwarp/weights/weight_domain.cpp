#include <puppetwarp/weights/weight_domain.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/extended_mesh.h>
#include <puppetwarp/mesh/locate.h>
#include <puppetwarp/mesh/outline.h>
#include <puppetwarp/rig/region.h>
#include <puppetwarp/weights/cage_checks.h>
#include <puppetwarp/weights/segment_foot.h>
#include <puppetwarp/weights/weight_conditions.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

namespace puppetwarp {

namespace {

std::vector<Polyline> cages_of(const Rig& rig) {
    std::vector<Polyline> cages;
    for (const Handle& handle : rig.handles) {
        if (const auto* cage = std::get_if<CageHandle>(&handle.shape)) cages.push_back(cage->points);
    }
    return cages;
}

// Indices of the vertices that handles name, each checked.
std::vector<int> named_vertices(const TriangleMesh& mesh, const Rig& rig) {
    std::vector<int> named;
    for (const Handle& handle : rig.handles) {
        const auto* vertex = std::get_if<VertexHandle>(&handle.shape);
        if (vertex == nullptr) continue;
        require_vertex(mesh, handle.id, *vertex);
        named.push_back(vertex->index);
    }
    return named;
}

// Vertices on an edge of a cage with their shares of the way along it, sorted by these.
std::vector<std::pair<double, int>> vertices_on(const TriangleMesh& mesh, const Point& a, const Point& b, double near) {
    std::vector<std::pair<double, int>> found;
    const Point low = a.cwiseMin(b).array() - near, high = a.cwiseMax(b).array() + near;
    for (int v = 0; v < mesh.V.rows(); ++v) {
        const Point p = mesh.V.row(v).transpose();
        if ((p.array() < low.array()).any() || (p.array() > high.array()).any()) continue;
        const SegmentFoot foot = segment_foot(a, b, p);
        if (foot.distance <= near) found.emplace_back(foot.along, v);
    }
    std::sort(found.begin(), found.end());
    return found;
}

// Whether the edges of a cage are chains of edges of the mesh.
bool is_made_of_edges(const TriangleMesh& mesh, const Polyline& cage, double near) {
    std::vector<std::pair<int, int>> wanted;
    for (std::size_t k = 0; k < cage.size(); ++k) {
        const Point &a = cage[k], &b = cage[(k + 1) % cage.size()];
        const std::vector<std::pair<double, int>> chain = vertices_on(mesh, a, b, near);
        const double length = (b - a).norm();
        if (chain.size() < 2 || chain.front().first * length > near || (1 - chain.back().first) * length > near) {
            return false;
        }
        for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
            wanted.push_back(std::minmax(chain[i].second, chain[i + 1].second));
        }
    }
    std::set<std::pair<int, int>> missing(wanted.begin(), wanted.end());
    for (Eigen::Index t = 0; t < mesh.F.rows() && !missing.empty(); ++t) {
        for (int k = 0; k < 3; ++k) missing.erase(std::minmax(mesh.F(t, k), mesh.F(t, (k + 1) % 3)));
    }
    return missing.empty();
}

// Whether the mesh has triangles everywhere in a cage that is made of its edges.
bool is_full(const TriangleMesh& mesh, const Polyline& cage) {
    const Eigen::VectorXd areas = double_areas(mesh.V, mesh.F);
    double area = 0;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        const Point centroid =
            (mesh.V.row(mesh.F(t, 0)) + mesh.V.row(mesh.F(t, 1)) + mesh.V.row(mesh.F(t, 2))).transpose() / 3;
        if (inside(cage, centroid)) area += std::abs(areas(t)) / 2;
    }
    constexpr double round_off = 1e-6;
    return area >= (1 - round_off) * std::abs(signed_area(cage));
}

SparseMatrix carry_back(const TriangleMesh& subject, const ExtendedMesh& extended) {
    std::vector<Eigen::Triplet<double>> entries;
    std::optional<MeshLocator> locator;
    for (int v = 0; v < subject.V.rows(); ++v) {
        const int place = extended.place[static_cast<std::size_t>(v)];
        if (place >= 0) {
            entries.emplace_back(v, place, 1.0);
            continue;
        }
        if (!locator) locator.emplace(extended.mesh);
        const MeshLocation found = locator->locate(subject.V.row(v).transpose());
        for (int k = 0; k < 3; ++k) {
            entries.emplace_back(v, extended.mesh.F(found.triangle, k), found.barycentric(k));
        }
    }
    SparseMatrix carry(subject.V.rows(), extended.mesh.V.rows());
    carry.setFromTriplets(entries.begin(), entries.end());
    return carry;
}

}  // namespace

WeightDomain weight_domain(const TriangleMesh& mesh, const Rig& rig) {
    require_sound_cages(mesh, rig);
    const std::vector<Polyline> cages = cages_of(rig);
    const double near = on_cage_edge * bounding_diagonal(mesh.V);
    const bool fits = std::all_of(cages.begin(), cages.end(), [&](const Polyline& cage) {
        return is_made_of_edges(mesh, cage, near) && is_full(mesh, cage);
    });
    if (fits) return {mesh, rig, std::nullopt};

    ExtendedMesh extended = extended_mesh(mesh, cages, named_vertices(mesh, rig));
    SparseMatrix carry = carry_back(mesh, extended);
    WeightDomain domain{std::move(extended.mesh), rig, std::move(carry)};
    for (Handle& handle : domain.rig.handles) {
        auto* vertex = std::get_if<VertexHandle>(&handle.shape);
        if (vertex == nullptr) continue;
        vertex->index = extended.place[static_cast<std::size_t>(vertex->index)];
        if (vertex->index >= 0) continue;
        throw InvalidInput("handle '" + handle.id + "'", "its vertex belongs to no triangle", "hold another");
    }
    return domain;
}

}  // namespace puppetwarp
