#include <puppetwarp/mesh/measures.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace puppetwarp {

namespace {

void count_edges(const TriangleMesh& mesh, MeshMeasures& measures) {
    std::vector<std::pair<int, int>> sides;  // of the triangles: an inner edge is there twice
    sides.reserve(static_cast<std::size_t>(3 * mesh.F.rows()));
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
        for (int k = 0; k < 3; ++k) sides.push_back(std::minmax<int>({mesh.F(f, k), mesh.F(f, (k + 1) % 3)}));
    }
    std::sort(sides.begin(), sides.end());
    for (std::size_t i = 0; i < sides.size();) {
        const std::size_t first = i;
        while (i < sides.size() && sides[i] == sides[first]) ++i;
        ++measures.edges;
        if (i - first == 1) ++measures.boundary_edges;
    }
}

}  // namespace

MeshMeasures measure_mesh(const TriangleMesh& mesh) {
    MeshMeasures measures;
    measures.components = vertex_components(mesh).maxCoeff() + 1;
    count_edges(mesh, measures);
    const double area = double_areas(mesh.V, mesh.F).sum() / 2;
    measures.area = std::abs(area);
    measures.clockwise = area > 0;
    measures.smallest_angle_rad = std::numbers::pi;
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const Eigen::RowVector2d corner = mesh.V.row(mesh.F(f, k));
            const Eigen::RowVector2d a = mesh.V.row(mesh.F(f, (k + 1) % 3)) - corner;
            const Eigen::RowVector2d b = mesh.V.row(mesh.F(f, (k + 2) % 3)) - corner;
            const double angle = std::atan2(std::abs(a.x() * b.y() - a.y() * b.x()), a.dot(b));
            measures.smallest_angle_rad = std::min(measures.smallest_angle_rad, angle);
            measures.longest_edge = std::max(measures.longest_edge, a.norm());
        }
    }
    return measures;
}

}  // namespace puppetwarp
