// Meshes that cages and subjects have together, and flips to Delaunay edges.

#include "reference/test_meshes.h"

#include <puppetwarp/mesh/automatic_cage.h>
#include <puppetwarp/mesh/extended_mesh.h>
#include <puppetwarp/mesh/locate.h>
#include <puppetwarp/mesh/operators.h>
#include <puppetwarp/mesh/triangle_sides.h>

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

namespace puppetwarp {

namespace {

// What a ring and a mesh hold together.
struct Scene {
    TriangleMesh mesh;
    Polyline ring;
};

Polyline circle(const Point& centre, double radius, int corners) {
    Polyline ring;
    for (int k = 0; k < corners; ++k) {
        const double angle = 2 * std::numbers::pi * k / corners;
        ring.push_back(centre + radius * Point(std::cos(angle), std::sin(angle)));
    }
    return ring;
}

TriangleMesh clockwise(TriangleMesh mesh) {
    mesh.F.col(1).swap(mesh.F.col(2));
    return mesh;
}

// Squares of 10 px, cut in two along parallel diagonals. As four corners lie on a circle, a triangulation may have the
// other diagonals.
TriangleMesh slanted_grid(int squares) {
    TriangleMesh mesh = reference::grid(squares, squares, 10 * squares, 10 * squares);
    for (Eigen::Index t = 0; t < mesh.F.rows(); t += 2) {
        const int a = mesh.F.block(t, 0, 2, 3).minCoeff(), b = a + 1, c = a + squares + 1, d = c + 1;
        mesh.F.row(t) << a, b, d;
        mesh.F.row(t + 1) << a, d, c;
    }
    return mesh;
}

// Rings around all of the mesh.
std::vector<Scene> scenes_around() {
    std::vector<Scene> scenes;
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
        const TriangleMesh blob = reference::blob(200, 6, seed);
        for (const int corners : {3, 12, 500}) scenes.push_back({blob, automatic_cage(blob, corners)});
    }
    const TriangleMesh figure = reference::figure(1000, 12);
    scenes.push_back({figure, automatic_cage(figure, 20)});
    scenes.push_back({clockwise(figure), automatic_cage(figure, 60)});
    const TriangleMesh ring = reference::annulus(20, 90, 40, 100);
    scenes.push_back({ring, automatic_cage(ring, 9)});
    const TriangleMesh two = reference::joined(reference::blob(200, 8, 5), reference::blob(200, 5, 6), {260, 40});
    scenes.push_back({two, automatic_cage(two, 14)});
    // Triangles so long that their circles reach beyond the boundary.
    const TriangleMesh needles = reference::grid(12, 90, 600, 90, 0.2);
    scenes.push_back({needles, {{-8, -1.5}, {608, -1.5}, {608, 91}, {310, 93}, {-8, 91}}});
    scenes.push_back({needles, circle({300, 45}, 420, 40)});
    scenes.push_back({needles, automatic_cage(needles, 200)});
    scenes.push_back({reference::grid(30, 20, 300, 200), circle({150, 100}, 260, 7)});
    return scenes;
}

// Rings that hold only parts.
std::vector<Scene> scenes_across() {
    const TriangleMesh figure = reference::figure(1000, 12);
    return {{figure, circle({500, 300}, 330, 12)},
            {figure, {{400, -50}, {600, -50}, {600, 320}, {400, 320}}},
            {clockwise(figure), circle({100, 200}, 150, 5)},
            {reference::grid(40, 40, 400, 400, 0.2), circle({200, 200}, 90, 6)},
            {slanted_grid(40), circle({200, 200}, 90, 4)},
            {reference::grid(40, 40, 400, 400), {{100, 100}, {300, 100}, {300, 300}, {100, 300}}}};
}

double point_distance(const Point& a, const Point& b, const Point& p) {
    const Point way = b - a;
    const double along = std::clamp(way.dot(p - a) / way.squaredNorm(), 0.0, 1.0);
    return (p - a - along * way).norm();
}

double ring_distance(const Polyline& ring, const Point& p) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < ring.size(); ++k) {
        least = std::min(least, point_distance(ring[k], ring[(k + 1) % ring.size()], p));
    }
    return least;
}

double area_of(const TriangleMesh& mesh) {
    return double_areas(mesh.V, mesh.F).sum() / 2;
}

// How much of each ring edge is made of edges of the mesh, as a share.
void expect_edges_along(const Polyline& ring, const TriangleMesh& mesh) {
    std::map<std::pair<int, int>, double> edges;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const int a = mesh.F(t, k), b = mesh.F(t, (k + 1) % 3);
            edges[std::minmax(a, b)] = (mesh.V.row(a) - mesh.V.row(b)).norm();
        }
    }
    const double near = 1e-9 * bounding_diagonal(mesh.V);
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const Point &a = ring[k], &b = ring[(k + 1) % ring.size()];
        double covered = 0;
        for (const auto& [ends, length] : edges) {
            if (point_distance(a, b, mesh.V.row(ends.first)) < near &&
                point_distance(a, b, mesh.V.row(ends.second)) < near) {
                covered += length;
            }
        }
        EXPECT_NEAR(covered, (b - a).norm(), 1e-6 * (b - a).norm()) << k;
    }
}

void expect_sound(const Scene& scene, const ExtendedMesh& extended) {
    EXPECT_NO_THROW(require_sound(extended.mesh, "extended"));
    EXPECT_GT(double_areas(extended.mesh.V, extended.mesh.F).minCoeff(), 0);
    expect_edges_along(scene.ring, extended.mesh);
    ASSERT_EQ(extended.place.size(), static_cast<std::size_t>(scene.mesh.V.rows()));
    double longest = 0;
    for (Eigen::Index t = 0; t < scene.mesh.F.rows(); ++t) {
        longest =
            std::max(longest, (scene.mesh.V.row(scene.mesh.F(t, 0)) - scene.mesh.V.row(scene.mesh.F(t, 1))).norm());
    }
    std::vector<bool> taken(static_cast<std::size_t>(extended.mesh.V.rows()));
    for (Eigen::Index v = 0; v < scene.mesh.V.rows(); ++v) {
        const int place = extended.place[static_cast<std::size_t>(v)];
        if (place < 0) {
            EXPECT_LT(ring_distance(scene.ring, scene.mesh.V.row(v)), longest) << v;
            continue;
        }
        EXPECT_FALSE(taken[static_cast<std::size_t>(place)]);
        taken[static_cast<std::size_t>(place)] = true;
        EXPECT_EQ(scene.mesh.V.row(v), extended.mesh.V.row(place)) << v;
    }
}

}  // namespace

TEST(ExtendedMesh, IsAllThatARingHolds) {
    int number = 0;
    for (const Scene& scene : scenes_around()) {
        SCOPED_TRACE(number++);
        const ExtendedMesh extended = extended_mesh(scene.mesh, {scene.ring}, {});
        expect_sound(scene, extended);
        double area = 0;
        for (std::size_t k = 1; k + 1 < scene.ring.size(); ++k) {
            const Point a = scene.ring[k] - scene.ring[0], b = scene.ring[k + 1] - scene.ring[0];
            area += (a.x() * b.y() - a.y() * b.x()) / 2;
        }
        EXPECT_NEAR(area_of(extended.mesh), std::abs(area), 1e-9 * std::abs(area));
    }
}

TEST(ExtendedMesh, HasDelaunayEdges) {
    // All stiffness between neighbours is then positive, and harmonic weights have their maximum at the rings.
    int number = 0;
    for (const Scene& scene : scenes_around()) {
        SCOPED_TRACE(number++);
        const SparseMatrix L = cotangent_stiffness(extended_mesh(scene.mesh, {scene.ring}, {}).mesh);
        for (Eigen::Index v = 0; v < L.outerSize(); ++v) {
            for (SparseMatrix::InnerIterator it(L, v); it; ++it) {
                if (it.row() == v) continue;
                EXPECT_LT(it.value(), 1e-6);
            }
        }
    }
}

TEST(ExtendedMesh, IsTheSubjectAndWhatARingHoldsBesides) {
    int number = 0;
    for (const Scene& scene : scenes_across()) {
        SCOPED_TRACE(number++);
        const ExtendedMesh extended = extended_mesh(scene.mesh, {scene.ring}, {});
        expect_sound(scene, extended);
        const MeshLocator subject(scene.mesh), whole(extended.mesh);
        const Outline ring{{{scene.ring, {}}}};
        const double edge = 15;
        const Eigen::RowVector2d low = extended.mesh.V.colwise().minCoeff(),
                                 high = extended.mesh.V.colwise().maxCoeff();
        for (double x = low.x() - 20; x < high.x() + 20; x += 7.3) {
            for (double y = low.y() - 20; y < high.y() + 20; y += 7.1) {
                const Point p(x, y);
                const double away = subject.locate(p).distance_px;
                const bool held = contains(ring, p) || away == 0;
                // Near where both end, the border may run a little differently.
                if (held) {
                    EXPECT_LT(whole.locate(p).distance_px, edge) << p.transpose();
                } else if (away > edge && ring_distance(scene.ring, p) > edge) {
                    EXPECT_GT(whole.locate(p).distance_px, 0) << p.transpose();
                }
            }
        }
    }
}

TEST(ExtendedMesh, KeepsTheVerticesItIsAskedToKeep) {
    const TriangleMesh grid = reference::grid(40, 40, 400, 400);
    const Polyline ring{{99, 99}, {301, 101}, {299, 302}, {101, 299}};
    const int crowded = reference::nearest_vertex(grid, {200, 100});
    EXPECT_LT(extended_mesh(grid, {ring}, {}).place[static_cast<std::size_t>(crowded)], 0);
    const ExtendedMesh extended = extended_mesh(grid, {ring}, {crowded});
    const int place = extended.place[static_cast<std::size_t>(crowded)];
    ASSERT_GE(place, 0);
    EXPECT_EQ(extended.mesh.V.row(place), grid.V.row(crowded));
}

TEST(DelaunayEdges, LeaveNoVertexInACircle) {
    for (std::uint32_t seed = 1; seed <= 5; ++seed) {
        const TriangleMesh grid = reference::grid(14, 9, 140, 90, 0.29, seed);
        std::vector<int> opposite = opposite_sides(grid.F, grid.V.rows());
        const TriangleMesh flipped{grid.V, with_delaunay_edges(grid.V, grid.F, opposite)};
        EXPECT_NE(flipped.F, grid.F);
        EXPECT_EQ(opposite, opposite_sides(flipped.F, flipped.V.rows()));
        EXPECT_GT(double_areas(flipped.V, flipped.F).minCoeff(), 0);
        EXPECT_NEAR(area_of(flipped), 140 * 90, 1e-9);
        for (Eigen::Index t = 0; t < flipped.F.rows(); ++t) {
            for (Eigen::Index v = 0; v < flipped.V.rows(); ++v) {
                Eigen::Matrix3d incircle;
                for (int k = 0; k < 3; ++k) {
                    const Eigen::RowVector2d d = flipped.V.row(flipped.F(t, k)) - flipped.V.row(v);
                    incircle.row(k) << d, d.squaredNorm();
                }
                EXPECT_LT(incircle.determinant(), 1e-3) << t << ' ' << v;
            }
        }
    }
}

TEST(TriangleSides, BoundaryRunsAsTheTrianglesDo) {
    const TriangleMesh grid = reference::grid(5, 3, 50, 30);
    double doubled = 0;
    const auto edges = boundary_edges(grid);
    for (const auto& [a, b] : edges) doubled += grid.V(a, 0) * grid.V(b, 1) - grid.V(a, 1) * grid.V(b, 0);
    EXPECT_EQ(edges.size(), 16U);
    EXPECT_NEAR(doubled, 2 * 50 * 30, 1e-9);
}

}  // namespace puppetwarp
