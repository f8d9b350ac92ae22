#include <puppetwarp/mesh/geodesic_distance.h>

#include <puppetwarp/base/point.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace puppetwarp {

namespace {

// The least of (distance at q, linear between a and b) + |q c| over the points q of the edge a b.
double distance_through(const Point& a, double distance_a, const Point& b, double distance_b, const Point& c) {
    const double length = (b - a).norm();
    if (!(length > 0)) return std::min(distance_a, distance_b) + (c - a).norm();
    const Point along = (b - a) / length;
    const double foot = (c - a).dot(along);
    const double height = std::abs((c - a).x() * along.y() - (c - a).y() * along.x());
    const double slope = (distance_b - distance_a) / length;
    double q = slope > 0 ? 0 : length;
    if (std::abs(slope) < 1) q = std::clamp(foot - height * slope / std::sqrt(1 - slope * slope), 0.0, length);
    return distance_a + slope * q + std::hypot(q - foot, height);
}

std::vector<std::vector<int>> triangles_at_vertices(const TriangleMesh& mesh) {
    std::vector<std::vector<int>> triangles(static_cast<std::size_t>(mesh.V.rows()));
    for (int t = 0; t < mesh.F.rows(); ++t) {
        for (int k = 0; k < 3; ++k) triangles[static_cast<std::size_t>(mesh.F(t, k))].push_back(t);
    }
    return triangles;
}

}  // namespace

Eigen::VectorXd geodesic_distance(const TriangleMesh& mesh, const std::vector<int>& sources) {
    using Reached = std::pair<double, int>;
    const auto triangles_at = triangles_at_vertices(mesh);
    Eigen::VectorXd distance = Eigen::VectorXd::Constant(mesh.V.rows(), std::numeric_limits<double>::infinity());
    std::vector<bool> settled(static_cast<std::size_t>(mesh.V.rows()));
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> front;
    for (const int v : sources) {
        distance(v) = 0;
        front.emplace(0.0, v);
    }
    const auto point = [&](int v) { return Point(mesh.V.row(v).transpose()); };
    // Reaches vertex c of triangle t from its settled vertex a, and across the edge from a to the other where that is
    // settled too.
    const auto reach = [&](int a, int b, int c) {
        if (settled[static_cast<std::size_t>(c)]) return;
        double reached = distance(a) + (point(c) - point(a)).norm();
        if (settled[static_cast<std::size_t>(b)]) {
            reached = std::min(reached, distance_through(point(a), distance(a), point(b), distance(b), point(c)));
        }
        if (reached >= distance(c)) return;
        distance(c) = reached;
        front.emplace(reached, c);
    };
    while (!front.empty()) {
        const int v = front.top().second;
        front.pop();
        if (settled[static_cast<std::size_t>(v)]) continue;
        settled[static_cast<std::size_t>(v)] = true;
        for (const int t : triangles_at[static_cast<std::size_t>(v)]) {
            for (int k = 0; k < 3; ++k) {
                if (mesh.F(t, k) != v) continue;
                reach(v, mesh.F(t, (k + 1) % 3), mesh.F(t, (k + 2) % 3));
                reach(v, mesh.F(t, (k + 2) % 3), mesh.F(t, (k + 1) % 3));
            }
        }
    }
    return distance;
}

}  // namespace puppetwarp
