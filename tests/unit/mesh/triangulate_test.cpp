#include <puppetwarp/mesh/triangulate.h>

#include "shapes.h"

#include <puppetwarp/base/errors.h>

#include <gmock/gmock.h>

#include <array>
#include <map>
#include <set>

namespace puppetwarp {

using namespace tests;

namespace {

std::array<Point, 3> corners_of(const TriangleMesh& mesh, Eigen::Index t) {
    return {mesh.V.row(mesh.F(t, 0)).transpose(), mesh.V.row(mesh.F(t, 1)).transpose(),
            mesh.V.row(mesh.F(t, 2)).transpose()};
}

double area_of(const std::array<Point, 3>& c) {
    const Point a = c[1] - c[0], b = c[2] - c[0];
    return 0.5 * (a.x() * b.y() - a.y() * b.x());
}

// Positive triangles that fit together edge to edge and sum up to the outline's area.
void expect_covers(const TriangleMesh& mesh, const Outline& outline) {
    double area = 0;
    std::map<std::pair<int, int>, int> sides;
    std::set<int> used;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        const double one = area_of(corners_of(mesh, t));
        EXPECT_GT(one, 0);
        area += one;
        for (int k = 0; k < 3; ++k) {
            ++sides[{mesh.F(t, k), mesh.F(t, (k + 1) % 3)}];
            used.insert(mesh.F(t, k));
        }
        const std::array<Point, 3> c = corners_of(mesh, t);
        EXPECT_TRUE(contains(outline, (c[0] + c[1] + c[2]) / 3));
    }
    for (const auto& [side, count] : sides) EXPECT_EQ(count, 1) << "a side with two triangles on it";
    EXPECT_EQ(used.size(), static_cast<std::size_t>(mesh.V.rows()));
    const double expected = tests::area_of(outline);
    EXPECT_NEAR(area, expected, 1e-9 * expected);
}

double longest_edge(const TriangleMesh& mesh) {
    double longest = 0;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        const std::array<Point, 3> c = corners_of(mesh, t);
        for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, (c[k] - c[(k + 1) % 3]).norm());
    }
    return longest;
}

double angle_deg(const Point& at, const Point& a, const Point& b) {
    const Point u = a - at, v = b - at;
    return std::acos(std::clamp(u.dot(v) / (u.norm() * v.norm()), -1.0, 1.0)) * 180 / std::numbers::pi;
}

// Smallest angle over triangles of which no corner is one of the outline's corners below 60 degrees.
double smallest_angle_away_from_corners(const TriangleMesh& mesh, const Outline& outline) {
    std::vector<Point> sharp;
    for (const Polyline& polygon : polygons_of(outline)) {
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            const Point& before = polygon[(k + polygon.size() - 1) % polygon.size()];
            if (angle_deg(polygon[k], before, polygon[(k + 1) % polygon.size()]) < 60) sharp.push_back(polygon[k]);
        }
    }
    double smallest = 180;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        const std::array<Point, 3> c = corners_of(mesh, t);
        bool at_sharp = false;
        for (const Point& p : c) at_sharp = at_sharp || std::find(sharp.begin(), sharp.end(), p) != sharp.end();
        if (at_sharp) continue;
        for (std::size_t k = 0; k < 3; ++k)
            smallest = std::min(smallest, angle_deg(c[k], c[(k + 1) % 3], c[(k + 2) % 3]));
    }
    return smallest;
}

double mean_smallest_angle(const TriangleMesh& mesh) {
    double sum = 0;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        const std::array<Point, 3> c = corners_of(mesh, t);
        sum += std::min({angle_deg(c[0], c[1], c[2]), angle_deg(c[1], c[2], c[0]), angle_deg(c[2], c[0], c[1])});
    }
    return sum / static_cast<double>(mesh.F.rows());
}

// How much of the segment is made of edges of the mesh.
double length_on_edges(const TriangleMesh& mesh, const Point& a, const Point& b) {
    const Point along = (b - a).normalized();
    std::set<std::pair<int, int>> on_line;
    const auto off = [&](const Point& p) { return std::abs(along.x() * (p - a).y() - along.y() * (p - a).x()); };
    const auto in_span = [&](const Point& p) { return along.dot(p - a) > -1e-6 && along.dot(p - b) < 1e-6; };
    double length = 0;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const int i = mesh.F(t, k), j = mesh.F(t, (k + 1) % 3);
            const Point p = mesh.V.row(i).transpose(), q = mesh.V.row(j).transpose();
            if (off(p) > 1e-6 || off(q) > 1e-6 || !in_span(p) || !in_span(q)) continue;
            if (on_line.insert(std::minmax(i, j)).second) length += (q - p).norm();
        }
    }
    return length;
}

double distance_to_vertices(const TriangleMesh& mesh, const Point& p) {
    return (mesh.V.rowwise() - p.transpose()).rowwise().norm().minCoeff();
}

Outline random_outline(std::mt19937& random) {
    Outline outline;
    outline.components.push_back({wavy_polygon(random, {300, 300}, 200, 90), {}});
    outline.components[0].holes.push_back(wavy_polygon(random, {260, 290}, 50, 40));
    outline.components[0].holes.push_back(wavy_polygon(random, {380, 340}, 20, 12));
    outline.components.push_back({wavy_polygon(random, {260, 290}, 20, 20), {}});  // an island
    outline.components.push_back({wavy_polygon(random, {700, 100}, 60, 25), {}});
    return outline;
}

}  // namespace

TEST(Triangulate, CoversRandomOutlinesWithGoodTriangles) {
    std::mt19937 random(11);
    for (int round = 0; round < 10; ++round) {
        SCOPED_TRACE(round);
        const Outline outline = random_outline(random);
        for (const double angle : {25.0, 30.0}) {
            TriangulationOptions options;
            options.max_edge_px = 30;
            options.min_angle_deg = angle;
            const TriangleMesh mesh = triangulate(outline, {}, options);
            expect_covers(mesh, outline);
            EXPECT_LE(longest_edge(mesh), 30);
            EXPECT_GE(smallest_angle_away_from_corners(mesh, outline), angle - 0.01);
        }
    }
}

TEST(Triangulate, KeepsEdgesShortBesideSharpCornersToo) {
    const Outline wedge{{{{{0, 0}, {500, 0}, {500, 20}}, {}}}};
    const Outline needle{{{{{0, 0}, {400, 0}, {400, 400}, {201, 400}, {200, 3}, {199, 400}, {0, 400}}, {}}}};
    for (const Outline& outline : {wedge, needle}) {
        for (const double angle : {0.0, 25.0}) {
            TriangulationOptions options;
            options.max_edge_px = 12;
            options.min_angle_deg = angle;
            const TriangleMesh mesh = triangulate(outline, {}, options);
            expect_covers(mesh, outline);
            EXPECT_LE(longest_edge(mesh), 12);
        }
    }
}

TEST(Triangulate, KeepsTheCornersOfTheOutline) {
    std::mt19937 random(2);
    const Outline outline = random_outline(random);
    const TriangleMesh mesh = triangulate(outline);
    std::set<std::pair<double, double>> vertices;
    for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) vertices.insert({mesh.V(v, 0), mesh.V(v, 1)});
    for (const Polyline& polygon : polygons_of(outline)) {
        for (const Point& point : polygon) EXPECT_TRUE(vertices.contains({point.x(), point.y()}));
    }
}

TEST(Triangulate, DefaultEdgeGivesMeshesThatSuitDragging) {
    std::mt19937 random(4);
    const Outline outline{{{wavy_polygon(random, {500, 500}, 400, 120), {}}}};
    const TriangleMesh mesh = triangulate(outline);
    EXPECT_GT(mesh.V.rows(), 1000);
    EXPECT_LT(mesh.V.rows(), 5000);
    EXPECT_LE(longest_edge(mesh), default_max_edge_px(outline));
    // Size does not matter.
    Outline large = outline;
    for (Point& point : large.components[0].outer) point *= 8;
    EXPECT_EQ(triangulate(large).V.rows(), mesh.V.rows());
}

TEST(Triangulate, MakesBonesEdges) {
    const Outline outline = rectangle_outline(400, 300);
    const std::vector<Polyline> bones{{{50, 60}, {180, 130}, {330, 120}}, {{180, 130}, {190, 250}}};
    const TriangleMesh mesh = triangulate(outline, bones, {.max_edge_px = 25});
    expect_covers(mesh, outline);
    for (const Polyline& bone : bones) {
        for (std::size_t k = 0; k + 1 < bone.size(); ++k) {
            EXPECT_NEAR(length_on_edges(mesh, bone[k], bone[k + 1]), (bone[k + 1] - bone[k]).norm(), 1e-6);
        }
    }
}

TEST(Triangulate, TakesTheInsideOfBonesThatLeaveTheOutline) {
    Outline outline = rectangle_outline(400, 300);
    outline.components[0].holes.push_back({{150, 100}, {150, 200}, {250, 200}, {250, 100}});
    const TriangleMesh mesh = triangulate(outline, {{{-80, 150}, {480, 150}}}, {.max_edge_px = 20});
    expect_covers(mesh, outline);
    // Inside from 0 to 150 and from 250 to 400, but for a tenth of an edge at each of the four ends.
    EXPECT_NEAR(length_on_edges(mesh, {0, 150}, {150, 150}), 150, 4.001);
    EXPECT_NEAR(length_on_edges(mesh, {250, 150}, {400, 150}), 150, 4.001);
}

TEST(Triangulate, TakesAwkwardBonesWithoutTinyTriangles) {
    const Outline outline = rectangle_outline(400, 300);
    const std::vector<Polyline> bones{
        {{0, 0}, {400, 0}},                 // on the boundary
        {{50, 50}, {0, 50}},                // ends on it
        {{50, 299.9999}, {350, 299.9999}},  // nearly on it
        {{100, 100}, {100, 100}},           // no length
        {{100, 100}, {300, 200}},
        {{100, 100}, {300, 200}},          // twice
        {{100, 200}, {300, 100}},          // across another
        {{300, 200.0000001}, {350, 200}},  // starts where another ends, nearly
        {{900, 900}, {1000, 900}},         // elsewhere
        {},
        {{5, 5}},
    };
    const TriangleMesh mesh = triangulate(outline, bones, {.max_edge_px = 20});
    expect_covers(mesh, outline);
    EXPECT_LT(mesh.F.rows(), 4000);
    double smallest = 1e300;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) smallest = std::min(smallest, area_of(corners_of(mesh, t)));
    EXPECT_GT(smallest, 0.05);
}

TEST(Triangulate, MakesPointsVertices) {
    std::mt19937 random(21);
    for (int round = 0; round < 10; ++round) {
        SCOPED_TRACE(round);
        const Outline outline = random_outline(random);
        const std::vector<Polyline> constraints{{{300, 200}}, {{200, 400}, {400, 420}}, {{333.25, 400}}, {{701, 99}}};
        for (const int smoothing : {0, 3}) {
            const TriangleMesh mesh =
                triangulate(outline, constraints, {.max_edge_px = 30, .optimize_iterations = smoothing});
            expect_covers(mesh, outline);
            for (const Polyline& constraint : constraints) {
                if (constraint.size() > 1) continue;
                EXPECT_EQ(distance_to_vertices(mesh, constraint[0]), 0);
            }
        }
    }
}

TEST(Triangulate, PutsPointsThatAlmostLieOnABoneOntoIt) {
    const Outline outline = rectangle_outline(400, 300);
    const Point from(50, 61), to(330, 127);
    const TriangleMesh plain = triangulate(outline, {{from, to}}, {.max_edge_px = 20});
    for (const double off : {0.0, 1e-13, 1e-7, 0.19}) {
        SCOPED_TRACE(off);
        const Point normal = Point(from.y() - to.y(), to.x() - from.x()).normalized();
        const Point foot = from + 0.3 * (to - from);
        const TriangleMesh mesh =
            triangulate(outline, {{foot + off * normal}, {from, to}, {from + off * normal}}, {.max_edge_px = 20});
        expect_covers(mesh, outline);
        EXPECT_LT(distance_to_vertices(mesh, foot), 1e-12);
        EXPECT_NEAR(length_on_edges(mesh, from, to), (to - from).norm(), 1e-6);
        EXPECT_LT(mesh.V.rows(), 1.1 * plain.V.rows());
    }
}

TEST(Triangulate, LeavesPointsOutThatCrowdTheBoundary) {
    const Outline outline = rectangle_outline(400, 300);
    const TriangleMesh plain = triangulate(outline, {}, {.max_edge_px = 20});
    const std::vector<Polyline> crowding{{{1.9, 100}}, {{0, 17}}, {{400, 300}}, {{-50, 20}}, {{200, 299}}};
    EXPECT_EQ(triangulate(outline, crowding, {.max_edge_px = 20}).V, plain.V);
    EXPECT_LT(distance_to_vertices(triangulate(outline, {{{2.1, 107}}}, {.max_edge_px = 20}), {2.1, 107}), 1e-12);
    EXPECT_THROW(triangulate(outline, {{{std::nan(""), 3}}}), InvalidInput);
}

TEST(Triangulate, TakesPointsInOnePlace) {
    const Outline outline = rectangle_outline(400, 300);
    const TriangleMesh mesh = triangulate(outline,
                                          {{{100, 100}},
                                           {{100, 100}},
                                           {{100.1, 100.1}},  // nearly
                                           {{150, 50}, {250, 150}},
                                           {{150, 150}, {250, 50}},
                                           {{200, 100}},        // where two bones cross
                                           {{150.05, 150.0}}},  // where one begins, nearly
                                          {.max_edge_px = 20});
    expect_covers(mesh, outline);
    for (const Point& place : {Point(100, 100), Point(200, 100), Point(150, 150)}) {
        EXPECT_LT(distance_to_vertices(mesh, place), 1e-12);
    }
    double smallest = 1e300;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) smallest = std::min(smallest, area_of(corners_of(mesh, t)));
    EXPECT_GT(smallest, 1);
}

TEST(Triangulate, GivesTheSameMeshEachTime) {
    std::mt19937 random(9);
    const Outline outline = random_outline(random);
    const std::vector<Polyline> bones{{{200, 400}, {400, 420}}, {{300, 200}}};
    const TriangulationOptions options{.optimize_iterations = 2};
    const TriangleMesh first = triangulate(outline, bones, options);
    for (int round = 0; round < 3; ++round) {
        // Other addresses for whatever the mesher allocates.
        std::vector<std::unique_ptr<char[]>> clutter;
        for (int k = 0; k < 2000; ++k) clutter.push_back(std::make_unique<char[]>(random() % 3000 + 1));
        for (std::size_t k = 0; k < clutter.size(); k += 2) clutter[k].reset();
        const TriangleMesh again = triangulate(outline, bones, options);
        ASSERT_EQ(again.V, first.V);
        ASSERT_EQ(again.F, first.F);
    }
}

TEST(Triangulate, OptimisesOnRequestOnly) {
    std::mt19937 random(6);
    const Outline outline = random_outline(random);
    TriangulationOptions options;
    options.max_edge_px = 30;
    const TriangleMesh plain = triangulate(outline, {}, options);
    options.optimize_iterations = 5;
    const TriangleMesh optimised = triangulate(outline, {}, options);
    expect_covers(optimised, outline);
    EXPECT_LE(longest_edge(optimised), 30);
    // Smoothing is for evenness: the mean of the triangles' smallest angles rises.
    EXPECT_GT(mean_smallest_angle(optimised), mean_smallest_angle(plain));
}

TEST(Triangulate, RefusesMoreVerticesThanAllowed) {
    TriangulationOptions options;
    options.max_edge_px = 1e-6;  // 10^17 triangles: refused before trying
    EXPECT_THROW(triangulate(rectangle_outline(1000, 1000), {}, options), InvalidInput);
    options.max_edge_px = 10;
    options.max_vertices = 12000;  // too few, though not by the first estimate
    EXPECT_THROW(triangulate(rectangle_outline(1000, 1000), {}, options), InvalidInput);
    options.max_vertices = 40000;
    EXPECT_LE(triangulate(rectangle_outline(1000, 1000), {}, options).V.rows(), 40000);
}

TEST(Triangulate, RefusesOptionsOutOfRange) {
    const Outline outline = rectangle_outline(10, 10);
    const double nan = std::nan("");
    for (const double angle : {-1.0, 30.5, nan}) {
        EXPECT_THROW(triangulate(outline, {}, {.min_angle_deg = angle}), InvalidInput);
    }
    for (const double edge : {-1.0, nan, static_cast<double>(INFINITY)}) {
        EXPECT_THROW(triangulate(outline, {}, {.max_edge_px = edge}), InvalidInput);
    }
}

TEST(Triangulate, SaysWhereAnOutlineCrossesItself) {
    const Outline bow{{{{{0, 0}, {100, 100}, {100, 0}, {0, 100}}, {}}}};
    try {
        triangulate(bow);
        FAIL() << "a bow tie was taken";
    } catch (const InvalidInput& error) {
        EXPECT_THAT(error.reason(), testing::HasSubstr("(50, 50)"));
    }
}

}  // namespace puppetwarp
