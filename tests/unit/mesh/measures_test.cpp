#include "shapes.h"

#include <puppetwarp/mesh/measures.h>
#include <puppetwarp/mesh/triangulate.h>

#include <gtest/gtest.h>

namespace puppetwarp::tests {
namespace {

TEST(MeshMeasures, OfASquareByHand) {
    TriangleMesh square;
    square.V.resize(5, 2);
    square.V << 0, 0, 3, 0, 3, 3, 0, 3, 9, 9;  // the last belongs to no triangle
    square.F.resize(2, 3);
    square.F << 0, 1, 2, 0, 2, 3;
    MeshMeasures measures = measure_mesh(square);
    EXPECT_EQ(measures.components, 2);
    EXPECT_EQ(measures.edges, 5);
    EXPECT_EQ(measures.boundary_edges, 4);
    EXPECT_DOUBLE_EQ(measures.area, 9);
    EXPECT_DOUBLE_EQ(measures.longest_edge, 3 * std::numbers::sqrt2);
    EXPECT_DOUBLE_EQ(measures.smallest_angle_rad, std::numbers::pi / 4);
    EXPECT_TRUE(measures.clockwise);  // to the right, then down

    square.V.col(1) *= -1;
    measures = measure_mesh(square);
    EXPECT_FALSE(measures.clockwise);
    EXPECT_DOUBLE_EQ(measures.area, 9);
}

// Euler's formula, by what was drawn: vertices - edges + triangles is 1 a piece less 1 a hole.
TEST(MeshMeasures, AgreeWithEulerOverShapesWithHoles) {
    std::mt19937 random(5);
    for (int holes = 0; holes < 3; ++holes) {
        OutlineComponent polygon;
        polygon.outer = wavy_polygon(random, {100, 100}, 80, 60);
        for (int k = 0; k < holes; ++k) {
            Polyline hole = wavy_polygon(random, {75.0 + 50 * k, 100}, 12, 20);
            std::reverse(hole.begin(), hole.end());
            polygon.holes.push_back(hole);
        }
        const TriangleMesh mesh = triangulate({{polygon}}, {}, {.max_edge_px = 9});
        const MeshMeasures measures = measure_mesh(mesh);
        EXPECT_EQ(mesh.V.rows() - measures.edges + mesh.F.rows(), 1 - holes);
        EXPECT_EQ(2 * measures.edges - measures.boundary_edges, 3 * mesh.F.rows());
        EXPECT_EQ(measures.components, 1);
        EXPECT_LE(measures.longest_edge, 9 * (1 + 1e-9));
        EXPECT_TRUE(measures.clockwise);
    }
}

}  // namespace
}  // namespace puppetwarp::tests
