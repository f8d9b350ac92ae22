#include <puppetwarp/mesh/mesh_core.h>

#include <puppetwarp/mesh/triangle_sides.h>

namespace puppetwarp {

MeshCore::MeshCore(const TriangleMesh& mesh)
    : F_(mesh.F),
      core_(static_cast<std::size_t>(mesh.F.rows()), true),
      vertices_(static_cast<std::size_t>(mesh.V.rows())) {
    if (double_areas(mesh.V, F_.topRows(1))(0) < 0) F_.col(1).swap(F_.col(2));
    opposite_ = opposite_sides(F_, mesh.V.rows());
    F_ = with_delaunay_edges(mesh.V, std::move(F_), opposite_);
}

std::vector<std::pair<int, int>> MeshCore::boundary() const {
    std::vector<std::pair<int, int>> edges;
    for (Eigen::Index t = 0; t < F_.rows(); ++t) {
        for (int k = 0; k < 3; ++k) {
            if (opposite_[static_cast<std::size_t>(3 * t + k)] < 0) edges.emplace_back(F_(t, k), F_(t, (k + 1) % 3));
        }
    }
    return edges;
}

std::vector<std::pair<int, int>> MeshCore::border() const {
    std::vector<std::pair<int, int>> edges;
    for (Eigen::Index t = 0; t < F_.rows(); ++t) {
        if (!holds(t)) continue;
        for (int k = 0; k < 3; ++k) {
            const int other = opposite_[static_cast<std::size_t>(3 * t + k)];
            if (other < 0 || !holds(other / 3)) edges.emplace_back(F_(t, k), F_(t, (k + 1) % 3));
        }
    }
    return edges;
}

std::vector<bool> MeshCore::inner_vertices() const {
    std::vector<bool> inner(vertices_), outer(vertices_);
    for (Eigen::Index t = 0; t < F_.rows(); ++t) {
        for (int k = 0; k < 3; ++k) (holds(t) ? inner : outer)[static_cast<std::size_t>(F_(t, k))] = true;
    }
    for (std::size_t v = 0; v < vertices_; ++v) inner[v] = inner[v] && !outer[v];
    return inner;
}

void MeshCore::loosen(std::vector<bool> vertices, int layers) {
    for (int layer = 0; layer <= layers; ++layer) {
        std::vector<bool> wider = vertices;
        for (Eigen::Index t = 0; t < F_.rows(); ++t) {
            bool near = false;
            for (int k = 0; k < 3; ++k) near = near || vertices[static_cast<std::size_t>(F_(t, k))];
            if (!near) continue;
            core_[static_cast<std::size_t>(t)] = false;
            for (int k = 0; k < 3; ++k) wider[static_cast<std::size_t>(F_(t, k))] = true;
        }
        vertices.swap(wider);
    }
}

}  // namespace puppetwarp
