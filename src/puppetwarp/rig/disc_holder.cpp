#include <puppetwarp/rig/disc_holder.h>

#include <puppetwarp/mesh/operators.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

// Smooth, so that the hold hardly changes when a vertex enters or leaves the disc.
double kernel(double distance, double radius) {
    const double q = distance / radius;
    return q < 1 ? (1 - q * q) * (1 - q * q) : 0;
}

}  // namespace

DiscHolder::DiscHolder(const TriangleMesh& mesh)
    : mesh_(mesh),
      locator_(mesh),
      component_(vertex_components(mesh)),
      mass_(lumped_mass(mesh)),
      gradients_(hat_gradients(mesh)),
      double_areas_(double_areas(mesh.V, mesh.F).cwiseAbs()),
      size_(bounding_diagonal(mesh.V)),
      triangles_at_(static_cast<std::size_t>(mesh.V.rows())) {
    for (int t = 0; t < mesh.F.rows(); ++t) {
        for (int k = 0; k < 3; ++k) triangles_at_[static_cast<std::size_t>(mesh.F(t, k))].push_back(t);
    }
}

// Vertices inside the disc that edges inside the disc connect with the triangle: what lies beside it across a gap stays
// free. Ascending.
std::vector<int> DiscHolder::reachable(int triangle, const Point& centre, double radius) const {
    std::vector<int> found;
    std::vector<bool> seen(static_cast<std::size_t>(mesh_.V.rows()));
    const auto visit = [&](int t) {
        for (int k = 0; k < 3; ++k) {
            const int v = mesh_.F(t, k);
            if (seen[static_cast<std::size_t>(v)] || distance(v, centre) >= radius) continue;
            seen[static_cast<std::size_t>(v)] = true;
            found.push_back(v);
        }
    };
    visit(triangle);
    for (std::size_t next = 0; next < found.size(); ++next) {
        for (const int t : triangles_at_[static_cast<std::size_t>(found[next])]) visit(t);
    }
    std::sort(found.begin(), found.end());
    return found;
}

ComplexRow DiscHolder::mean_over_disc(const std::vector<int>& vertices, const Point& centre, double radius) const {
    ComplexRow row;
    double sum = 0;
    for (const int v : vertices) {
        const double weight = mass_(v) * kernel(distance(v, centre), radius);
        row.emplace_back(v, weight);
        sum += weight;
    }
    for (auto& [vertex, weight] : row) weight /= sum;
    return row;
}

// Tilts the weights so that the mean lies at the centre itself: what follows a rigid motion of the handle is then the
// rigid motion. \return false, and nothing is changed, where a weight would turn negative.
bool DiscHolder::centre_mean(ComplexRow& row, const Point& centre) const {
    Eigen::Vector2d first = Eigen::Vector2d::Zero();
    Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
    const auto arm = [&](int vertex) -> Eigen::Vector2d { return mesh_.V.row(vertex).transpose() - centre; };
    for (const auto& [vertex, weight] : row) {
        first += weight.real() * arm(vertex);
        second += weight.real() * arm(vertex) * arm(vertex).transpose();
    }
    const Eigen::Vector2d tilt = -second.ldlt().solve(first);
    const double scale = 1 / (1 + first.dot(tilt));
    for (const auto& [vertex, weight] : row) {
        if (!(scale * (1 + tilt.dot(arm(vertex))) > 0)) return false;
    }
    for (auto& [vertex, weight] : row) weight *= scale * (1 + tilt.dot(arm(vertex)));
    return true;
}

// Shares of the triangles in the disc's mean derivative, ascending, sum 1.
std::vector<std::pair<int, double>> DiscHolder::triangle_weights(const std::vector<int>& vertices, const Point& centre,
                                                                 double radius, int triangle) const {
    std::vector<int> triangles;
    for (const int v : vertices) {
        const auto& at = triangles_at_[static_cast<std::size_t>(v)];
        triangles.insert(triangles.end(), at.begin(), at.end());
    }
    std::sort(triangles.begin(), triangles.end());
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());

    std::vector<std::pair<int, double>> weights;
    double sum = 0;
    for (const int t : triangles) {
        const Point centroid =
            (mesh_.V.row(mesh_.F(t, 0)) + mesh_.V.row(mesh_.F(t, 1)) + mesh_.V.row(mesh_.F(t, 2))) / 3;
        const double weight = double_areas_(t) * kernel((centroid - centre).norm(), radius);
        if (weight <= 0) continue;
        weights.emplace_back(t, weight);
        sum += weight;
    }
    if (weights.empty()) return {{triangle, 1}};
    for (auto& [t, weight] : weights) weight /= sum;
    return weights;
}

// Weighted mean of f_z = sum over the corners of 1/2 conj(g_k) w_k.
ComplexRow DiscHolder::mean_turn(const std::vector<std::pair<int, double>>& weights) const {
    ComplexRow row;
    for (const auto& [t, weight] : weights) {
        for (int k = 0; k < 3; ++k) {
            row.emplace_back(mesh_.F(t, k), std::conj(gradients_(t, k)) * (0.5 * weight));
        }
    }
    std::stable_sort(row.begin(), row.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    ComplexRow merged;
    for (const auto& entry : row) {
        if (!merged.empty() && merged.back().first == entry.first) {
            merged.back().second += entry.second;
        } else {
            merged.push_back(entry);
        }
    }
    return merged;
}

double DiscHolder::longest_edge(int triangle) const {
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
        const Point p = mesh_.V.row(mesh_.F(triangle, k)), q = mesh_.V.row(mesh_.F(triangle, (k + 1) % 3));
        longest = std::max(longest, (q - p).norm());
    }
    return longest;
}

Hold DiscHolder::hold(const MeshLocation& place, const Point& at, double radius) const {
    Hold hold;
    hold.at = {at.x(), at.y()};
    hold.component = component_(mesh_.F(place.triangle, 0));
    hold.radius_px = radius;
    std::vector<int> vertices = reachable(place.triangle, at, radius);
    if (vertices.size() >= 3) hold.mean = mean_over_disc(vertices, at, radius);
    const bool centred = vertices.size() >= 3 && centre_mean(hold.mean, at);
    // Where the outline cuts the disc, its mean lies inside of the point and stays there. A disc that is smaller than
    // the triangles around it has no mean worth the name: the triangle takes its place.
    if (!centred && (vertices.size() < 3 || radius < longest_edge(place.triangle))) {
        vertices.clear();
        hold.mean.clear();
        hold.radius_px = std::sqrt(double_areas_(place.triangle));
        for (int k = 0; k < 3; ++k) {
            const double weight = place.barycentric(k);
            if (weight > 0) hold.mean.emplace_back(mesh_.F(place.triangle, k), weight);
        }
    }
    hold.turn = mean_turn(triangle_weights(vertices, at, hold.radius_px, place.triangle));
    // f_zbar is the same with g_k.
    hold.shear = hold.turn;
    for (auto& [vertex, coefficient] : hold.shear) coefficient = std::conj(coefficient);
    return hold;
}

}  // namespace puppetwarp
