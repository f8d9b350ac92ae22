#include <puppetwarp/mesh/boundary_edges.h>

#include <algorithm>

namespace puppetwarp {

std::vector<std::pair<int, int>> boundary_edges(const TriangleMesh& mesh) {
    std::vector<std::pair<int, int>> sides;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        for (int k = 0; k < 3; ++k) sides.emplace_back(mesh.F(t, k), mesh.F(t, (k + 1) % 3));
    }
    std::sort(sides.begin(), sides.end());
    std::vector<std::pair<int, int>> lone;
    for (const auto& side : sides) {
        if (!std::binary_search(sides.begin(), sides.end(), std::pair(side.second, side.first))) lone.push_back(side);
    }
    return lone;
}

}  // namespace puppetwarp
