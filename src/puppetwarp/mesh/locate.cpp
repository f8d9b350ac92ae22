#include <puppetwarp/mesh/locate.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

namespace puppetwarp {

namespace {

using Corners = std::array<Point, 3>;

double cross(const Point& a, const Point& b) {
    return a.x() * b.y() - a.y() * b.x();
}

// Barycentric coordinates, not clamped; none for a triangle of no area.
bool barycentric(const Corners& c, const Point& p, Eigen::Vector3d& weights) {
    const double area = cross(c[1] - c[0], c[2] - c[0]);
    if (area == 0) return false;
    for (std::size_t k = 0; k < 3; ++k) {
        weights[static_cast<Eigen::Index>(k)] = cross(c[(k + 1) % 3] - p, c[(k + 2) % 3] - p) / area;
    }
    return true;
}

struct Nearest {
    double squared = std::numeric_limits<double>::infinity();
    Eigen::Vector3d weights = Eigen::Vector3d::UnitX();
};

// The nearest point of the triangle's border.
Nearest nearest_on_border(const Corners& c, const Point& p) {
    Nearest best;
    for (std::size_t k = 0; k < 3; ++k) {
        const Point& a = c[k];
        const Point edge = c[(k + 1) % 3] - a;
        const double squared = edge.squaredNorm();
        const double t = squared > 0 ? std::clamp((p - a).dot(edge) / squared, 0.0, 1.0) : 0.0;
        const double distance = (a + t * edge - p).squaredNorm();
        if (distance < best.squared) {
            best.squared = distance;
            best.weights.setZero();
            best.weights[static_cast<Eigen::Index>(k)] = 1 - t;
            best.weights[static_cast<Eigen::Index>((k + 1) % 3)] = t;
        }
    }
    return best;
}

}  // namespace

// Buckets of triangle indices over the bounding box; about one triangle a cell.
struct MeshLocator::Grid {
    std::vector<Corners> triangles;
    Point origin = Point::Zero();
    double cell = 1;
    int columns = 1, rows = 1;
    std::vector<int> first;  // of each cell's triangles in `members`, ascending
    std::vector<int> members;

    int column(double x) const { return index((x - origin.x()) / cell, columns); }
    int row(double y) const { return index((y - origin.y()) / cell, rows); }

    void search_cell(int i, int j, const Point& p, MeshLocation& best, double& best_squared) const {
        const auto at = static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(i);
        for (int m = first[at]; m < first[at + 1]; ++m) {
            const int triangle = members[static_cast<std::size_t>(m)];
            const Corners& corners = triangles[static_cast<std::size_t>(triangle)];
            Eigen::Vector3d weights;
            double squared = 0;
            if (!barycentric(corners, p, weights) || !(weights.minCoeff() >= 0)) {
                const Nearest nearest = nearest_on_border(corners, p);
                squared = nearest.squared;
                weights = nearest.weights;
            }
            if (squared < best_squared || (squared == best_squared && triangle < best.triangle)) {
                best_squared = squared;
                best.triangle = triangle;
                best.barycentric = weights;
            }
        }
    }

private:
    static int index(double cells, int count) {
        return cells >= count ? count - 1 : cells > 0 ? static_cast<int>(cells) : 0;
    }
};

MeshLocator::MeshLocator(const TriangleMesh& mesh) : grid_(std::make_unique<Grid>()) {
    assert(mesh.F.rows() > 0);
    Grid& grid = *grid_;
    const double infinity = std::numeric_limits<double>::infinity();
    Point low(infinity, infinity), high(-infinity, -infinity);
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        Corners& corners = grid.triangles.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
            corners[k] = mesh.V.row(mesh.F(t, static_cast<Eigen::Index>(k))).transpose();
            low = low.cwiseMin(corners[k]);
            high = high.cwiseMax(corners[k]);
        }
    }
    const Point size = high - low;
    const double count = static_cast<double>(grid.triangles.size());
    grid.origin = low;
    grid.cell = std::max({std::sqrt(size.x() * size.y() / count), size.maxCoeff() / (2 * count + 16), 1e-300});
    grid.columns = static_cast<int>(size.x() / grid.cell) + 1;
    grid.rows = static_cast<int>(size.y() / grid.cell) + 1;

    const auto for_each_cell = [&](const auto& visit) {
        for (std::size_t t = 0; t < grid.triangles.size(); ++t) {
            const Corners& c = grid.triangles[t];
            const Point least = c[0].cwiseMin(c[1]).cwiseMin(c[2]), most = c[0].cwiseMax(c[1]).cwiseMax(c[2]);
            for (int j = grid.row(least.y()); j <= grid.row(most.y()); ++j) {
                for (int i = grid.column(least.x()); i <= grid.column(most.x()); ++i) {
                    visit(static_cast<std::size_t>(j) * static_cast<std::size_t>(grid.columns) +
                              static_cast<std::size_t>(i),
                          static_cast<int>(t));
                }
            }
        }
    };
    grid.first.assign(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows) + 1, 0);
    for_each_cell([&](std::size_t cell, int) { ++grid.first[cell + 1]; });
    for (std::size_t cell = 1; cell < grid.first.size(); ++cell) grid.first[cell] += grid.first[cell - 1];
    grid.members.resize(static_cast<std::size_t>(grid.first.back()));
    std::vector<int> next(grid.first.begin(), grid.first.end() - 1);
    for_each_cell([&](std::size_t cell, int t) { grid.members[static_cast<std::size_t>(next[cell]++)] = t; });
}

MeshLocator::~MeshLocator() = default;
MeshLocator::MeshLocator(MeshLocator&&) noexcept = default;
MeshLocator& MeshLocator::operator=(MeshLocator&&) noexcept = default;

MeshLocation MeshLocator::locate(const Point& point) const {
    const Grid& grid = *grid_;
    MeshLocation best;
    double best_squared = std::numeric_limits<double>::infinity();
    const int i0 = grid.column(point.x()), j0 = grid.row(point.y());
    // How far the point is outside the grid comes on top of whatever the rings say.
    const Point inside = point.cwiseMax(grid.origin).cwiseMin(grid.origin + grid.cell * Point(grid.columns, grid.rows));
    const double outside = std::hypot(point.x() - inside.x(), point.y() - inside.y());
    // So far away that squares could overflow; the mesh is a point as seen from there.
    if (outside > 1e6 * grid.cell * std::max(grid.columns, grid.rows)) {
        MeshLocation location = locate(inside);
        location.distance_px = outside;
        return location;
    }
    const int most = std::max(grid.columns, grid.rows);
    for (int ring = 0; ring <= most; ++ring) {
        // Cells of this ring are at least ring - 1 cells away from the point.
        const double reach = std::max(outside, (ring - 1) * grid.cell);
        if (ring > 0 && (best_squared == 0 || best_squared < reach * reach)) break;
        for (int j = std::max(0, j0 - ring); j <= std::min(grid.rows - 1, j0 + ring); ++j) {
            const bool whole_row = j == j0 - ring || j == j0 + ring;
            const int step = whole_row || ring == 0 ? 1 : 2 * ring;
            for (int i = i0 - ring; i <= i0 + ring; i += step) {
                if (i >= 0 && i < grid.columns) grid.search_cell(i, j, point, best, best_squared);
            }
        }
    }
    best.distance_px = std::sqrt(best_squared);
    // Rounding may leave weights a hair outside [0, 1].
    best.barycentric = best.barycentric.cwiseMax(0).cwiseMin(1);
    best.barycentric /= best.barycentric.sum();
    return best;
}

}  // namespace puppetwarp
