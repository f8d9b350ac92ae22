#include <puppetwarp/mesh/locate.h>

#include "shapes.h"

#include <puppetwarp/mesh/triangulate.h>

#include <gtest/gtest.h>

namespace puppetwarp {

using namespace tests;

namespace {

double segment_distance(const Point& p, const Point& a, const Point& b) {
    const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    return (a + t * (b - a) - p).norm();
}

// Over all triangles: 0 inside, else the nearest side.
double distance_by_search(const TriangleMesh& mesh, const Point& p, int& triangle) {
    double best = 1e300;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        double distance = 1e300;
        bool inside = true;
        for (int k = 0; k < 3; ++k) {
            const Point a = mesh.V.row(mesh.F(t, k)).transpose(), b = mesh.V.row(mesh.F(t, (k + 1) % 3)).transpose();
            inside = inside && (b - a).x() * (p - a).y() - (b - a).y() * (p - a).x() >= 0;
            distance = std::min(distance, segment_distance(p, a, b));
        }
        if (inside) distance = 0;
        if (distance < best) {
            best = distance;
            triangle = static_cast<int>(t);
        }
    }
    return best;
}

}  // namespace

TEST(MeshLocator, AgreesWithASearchThroughAllTriangles) {
    std::mt19937 random(21);
    Outline outline{{{wavy_polygon(random, {100, 100}, 70, 40), {wavy_polygon(random, {90, 100}, 25, 20)}},
                     {wavy_polygon(random, {260, 60}, 15, 9), {}}}};
    const TriangleMesh mesh = triangulate(outline, {}, {.max_edge_px = 15});
    const MeshLocator locator(mesh);
    std::uniform_real_distribution<double> x(-150, 450), y(-150, 350);
    for (int k = 0; k < 1500; ++k) {
        const Point p(x(random), y(random));
        int triangle = -1;
        const double expected = distance_by_search(mesh, p, triangle);
        const MeshLocation found = locator.locate(p);
        ASSERT_NEAR(found.distance_px, expected, 1e-9) << p.transpose();
        if (expected == 0) {
            ASSERT_EQ(found.triangle, triangle);
        }
        ASSERT_GE(found.barycentric.minCoeff(), 0);
        ASSERT_NEAR(found.barycentric.sum(), 1, 1e-12);
        Point nearest = Point::Zero();
        for (int c = 0; c < 3; ++c) nearest += found.barycentric[c] * mesh.V.row(mesh.F(found.triangle, c)).transpose();
        ASSERT_NEAR((nearest - p).norm(), expected, 1e-9);
    }
}

TEST(MeshLocator, GivesTiesToTheLowestTriangle) {
    TriangleMesh mesh{Eigen::MatrixX2d(4, 2), Eigen::MatrixX3i(2, 3)};
    mesh.V << 0, 0, 8, 0, 8, 8, 0, 8;
    mesh.F << 0, 1, 2, 0, 2, 3;
    EXPECT_EQ(MeshLocator(mesh).locate({4, 4}).triangle, 0);
    EXPECT_EQ(MeshLocator(mesh).locate({0, 0}).triangle, 0);
    EXPECT_EQ(MeshLocator(mesh).locate({-5, -5}).triangle, 0);
    mesh.F.row(0).swap(mesh.F.row(1));
    EXPECT_EQ(MeshLocator(mesh).locate({4, 4}).triangle, 0);
    EXPECT_EQ(MeshLocator(mesh).locate({2, 5}).triangle, 0);
    EXPECT_EQ(MeshLocator(mesh).locate({5, 2}).triangle, 1);
}

TEST(MeshLocator, TakesEitherOrientation) {
    TriangleMesh mesh{Eigen::MatrixX2d(3, 2), Eigen::MatrixX3i(1, 3)};
    mesh.V << 0, 0, 8, 0, 0, 8;
    mesh.F << 0, 2, 1;
    const MeshLocation found = MeshLocator(mesh).locate({2, 4});
    EXPECT_EQ(found.distance_px, 0);
    EXPECT_TRUE(found.barycentric.isApprox(Eigen::Vector3d(0.25, 0.5, 0.25)));
}

}  // namespace puppetwarp
