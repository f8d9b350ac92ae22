#include <puppetwarp/mesh/constrained_triangles.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace puppetwarp {

double squared_sine(double angle_deg) {
    const double sine = std::sin(angle_deg * std::numbers::pi / 180);
    return sine * sine;
}

Refinement refine_domain(Mesher& mesher, const Cdt& cdt, std::size_t max_vertices) {
    // Where round-off makes a triangle flat, the mesher splits it for ever and no vertex is gained: more steps in
    // vain than there are triangles and edges have no end.
    std::size_t count = cdt.number_of_vertices(), in_vain = 0;
    do {
        if (cdt.number_of_vertices() > max_vertices) return Refinement::too_many;
        in_vain = cdt.number_of_vertices() > count ? 0 : in_vain + 1;
        count = cdt.number_of_vertices();
        if (in_vain > 1000 + 10 * count) return Refinement::in_vain;
    } while (mesher.try_one_step_refine_mesh());
    return Refinement::done;
}

TriangleMesh domain_triangles(Cdt& cdt) {
    int vertices = 0, triangles = 0;
    for (const Cdt::Vertex_handle vertex : cdt.finite_vertex_handles()) vertex->info() = -1;
    for (const Cdt::Face_handle face : cdt.finite_face_handles()) {
        if (!face->is_in_domain()) continue;
        ++triangles;
        for (int k = 0; k < 3; ++k) face->vertex(k)->info() = 0;
    }
    for (const Cdt::Vertex_handle vertex : cdt.finite_vertex_handles()) {
        if (vertex->info() == 0) vertex->info() = vertices++;
    }
    TriangleMesh mesh{Eigen::MatrixX2d(vertices, 2), Eigen::MatrixX3i(triangles, 3)};
    for (const Cdt::Vertex_handle vertex : cdt.finite_vertex_handles()) {
        if (vertex->info() >= 0) mesh.V.row(vertex->info()) << vertex->point().x(), vertex->point().y();
    }
    std::vector<std::array<int, 3>> corners;
    for (const Cdt::Face_handle face : cdt.finite_face_handles()) {
        if (!face->is_in_domain()) continue;
        std::array<int, 3> triangle{face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()};
        std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
        corners.push_back(triangle);
    }
    std::sort(corners.begin(), corners.end());
    for (int t = 0; t < triangles; ++t) {
        const auto& triangle = corners[static_cast<std::size_t>(t)];
        mesh.F.row(t) << triangle[0], triangle[1], triangle[2];
    }
    return mesh;
}

}  // namespace puppetwarp
