// Cages around outlines of all kinds: they hold the subject, keep off it, do not cross themselves, and are tight.

#include "reference/test_meshes.h"
#include "shapes.h"
#include "support/message_of.h"

#include <fuzz/outline_text.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/mesh/automatic_cage.h>
#include <puppetwarp/mesh/triangulate.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

namespace puppetwarp {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double margin_share = 0.01;

// How often a polygon winds around a point, by the angles under which its edges are seen.
double winding(const Polyline& polygon, const Point& p) {
    double turn = 0;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Point a = polygon[k] - p, b = polygon[(k + 1) % polygon.size()] - p;
        turn += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    }
    return turn / (2 * pi);
}

double point_distance(const Point& a, const Point& b, const Point& p) {
    const Point way = b - a;
    const double along = way.squaredNorm() > 0 ? std::clamp(way.dot(p - a) / way.squaredNorm(), 0.0, 1.0) : 0;
    return (p - a - along * way).norm();
}

// Of two edges that do not cross.
double edge_distance(const Point& a, const Point& b, const Point& c, const Point& d) {
    return std::min(
        {point_distance(a, b, c), point_distance(a, b, d), point_distance(c, d, a), point_distance(c, d, b)});
}

bool cross_each_other(const Point& a, const Point& b, const Point& c, const Point& d) {
    const auto side = [](const Point& s, const Point& t, const Point& p) {
        const long double x = static_cast<long double>(t.x() - s.x()) * (p.y() - s.y());
        const long double y = static_cast<long double>(t.y() - s.y()) * (p.x() - s.x());
        return (x > y) - (x < y);
    };
    const bool boxes = (a.cwiseMin(b).array() <= c.cwiseMax(d).array()).all() &&
                       (c.cwiseMin(d).array() <= a.cwiseMax(b).array()).all();
    return boxes && side(a, b, c) * side(a, b, d) <= 0 && side(c, d, a) * side(c, d, b) <= 0;
}

double diagonal_of(const Outline& outline) {
    Point low = Point::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const Polyline& polygon : tests::polygons_of(outline)) {
        for (const Point& p : polygon) {
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
    }
    return (high - low).norm();
}

void expect_simple(const Polyline& cage, double diagonal) {
    const std::size_t n = cage.size();
    for (std::size_t k = 0; k < n; ++k) {
        const Point &a = cage[k], &b = cage[(k + 1) % n];
        EXPECT_GT((b - a).norm(), 1e-4 * diagonal) << k;
        for (std::size_t m = k + 2; m < n; ++m) {
            if ((m + 1) % n == k) continue;
            EXPECT_FALSE(cross_each_other(a, b, cage[m], cage[(m + 1) % n])) << k << ' ' << m;
        }
    }
}

void expect_cage(const Polyline& cage, const Outline& outline, int corners) {
    ASSERT_EQ(cage.size(), static_cast<std::size_t>(corners));
    EXPECT_GT(signed_area(cage), 0);
    const double diagonal = diagonal_of(outline);
    expect_simple(cage, diagonal);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Polyline& polygon : tests::polygons_of(outline)) {
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            ASSERT_NEAR(winding(cage, polygon[k]), 1, 1e-6);
            const Point& next = polygon[(k + 1) % polygon.size()];
            for (std::size_t m = 0; m < cage.size(); ++m) {
                const Point &a = cage[m], &b = cage[(m + 1) % cage.size()];
                ASSERT_FALSE(cross_each_other(a, b, polygon[k], next));
                nearest = std::min(nearest, edge_distance(a, b, polygon[k], next));
            }
        }
    }
    EXPECT_GT(nearest, 0.95 * margin_share * diagonal);
    // And it leans on the subject.
    EXPECT_LT(nearest, 1.05 * margin_share * diagonal);
}

Outline outline_of(const Polyline& polygon) {
    return {{{polygon, {}}}};
}

Polyline regular(int points, double radius, const Point& centre = {0, 0}) {
    Polyline polygon;
    for (int k = 0; k < points; ++k) {
        polygon.push_back(centre + radius * Point(std::cos(2 * pi * k / points), std::sin(2 * pi * k / points)));
    }
    return polygon;
}

// Some blobs and stars, apart or over each other.
Outline random_outline(std::uint32_t seed) {
    std::mt19937 random(seed);
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
    };
    Outline outline;
    const int count = 1 + static_cast<int>(random() % 5);
    for (int k = 0; k < count; ++k) {
        const Point centre(uniform(0, 800), uniform(0, 500));
        const double radius = uniform(5, 250);
        if (random() % 2 == 0) {
            outline.components.push_back({tests::wavy_polygon(random, centre, radius, 60), {}});
            continue;
        }
        Polyline star = regular(3 + static_cast<int>(random() % 20), radius, centre);
        for (Point& p : star) p = centre + uniform(0.15, 1) * (p - centre);
        outline.components.push_back({star, {}});
    }
    return outline;
}

template <class Map>
Outline mapped(Outline outline, const Map& map) {
    for (OutlineComponent& component : outline.components) {
        for (Point& p : component.outer) p = map(p);
    }
    return outline;
}

double hull_area(const TriangleMesh& mesh) {
    // The convex hull seen from 720 directions.
    Polyline hull;
    for (int k = 0; k < 720; ++k) {
        const Eigen::Vector2d way(std::cos(pi * k / 360), std::sin(pi * k / 360));
        Eigen::Index farthest = 0;
        (mesh.V * way).maxCoeff(&farthest);
        hull.emplace_back(mesh.V.row(farthest).transpose());
    }
    return signed_area(hull);
}

}  // namespace

TEST(AutomaticCage, HoldsEveryOutlineOfTheCorpus) {
    namespace fs = std::filesystem;
    int good = 0;
    for (const fs::directory_entry& entry :
         fs::directory_iterator(fs::path(PUPPETWARP_SOURCE_DIR) / "tests/fuzz/corpus/outline")) {
        const std::string name = entry.path().filename().string();
        SCOPED_TRACE(name);
        std::stringstream text;
        text << std::ifstream(entry.path()).rdbuf();
        const Outline outline = tests::parse_outline_text(text.str()).outline;
        for (const int corners : {3, 4, 5, 8, 20, 61}) {
            SCOPED_TRACE(corners);
            Polyline cage;
            const std::string refused = message_of([&] { cage = automatic_cage(outline, corners); });
            // Not sound outlines may be refused, for coordinates that are none; the good ones never are.
            if (!refused.empty()) {
                EXPECT_TRUE(name.starts_with("bad_")) << refused;
            } else {
                expect_cage(cage, outline, corners);
            }
        }
        good += name.starts_with("good_");
    }
    EXPECT_GE(good, 14);
}

TEST(AutomaticCage, HoldsRandomOutlines) {
    for (std::uint32_t seed = 1; seed <= 30; ++seed) {
        SCOPED_TRACE(seed);
        const Outline outline = random_outline(seed);
        const int corners = 3 + static_cast<int>(seed * seed % 38);
        expect_cage(automatic_cage(outline, corners), outline, corners);
    }
}

TEST(AutomaticCage, TakesAsManyCornersAsThereMayBe) {
    const Outline outline = random_outline(7);
    expect_cage(automatic_cage(outline, most_cage_corners), outline, most_cage_corners);
}

TEST(AutomaticCage, FollowsArmsAndLegs) {
    constexpr double size = 1000;
    const TriangleMesh figure = reference::figure(size, 12);
    const Polyline cage = automatic_cage(figure, 20);
    const double area = double_areas(figure.V, figure.F).sum() / 2;
    EXPECT_LT(signed_area(cage), 1.6 * area);
    EXPECT_GT(hull_area(figure), 2 * area);
    for (Eigen::Index v = 0; v < figure.V.rows(); ++v) {
        ASSERT_NEAR(winding(cage, figure.V.row(v).transpose()), 1, 1e-6);
    }
    // Over and under the arms, between the legs.
    for (const Point& outside :
         {Point(0.25, 0.2), Point(0.75, 0.3), Point(0.25, 0.5), Point(0.7, 0.65), Point(0.51, 0.93)}) {
        EXPECT_NEAR(winding(cage, size * outside), 0, 1e-6) << outside.transpose();
    }
}

TEST(AutomaticCage, IsAboutAsSmallAsCanBe) {
    // Around a circle, the smallest polygon of n corners is the regular one.
    constexpr double radius = 100, around = radius + margin_share * std::numbers::sqrt2 * 2 * radius;
    for (const int corners : {3, 4, 5, 6, 8, 12, 16}) {
        const double least = corners * std::tan(pi / corners) * around * around;
        const double area = signed_area(automatic_cage(outline_of(regular(360, radius)), corners));
        EXPECT_LT(area, 1.02 * least) << corners;
        EXPECT_GT(area, 0.99 * least) << corners;
    }
}

TEST(AutomaticCage, OfAPhotographIsItsFrame) {
    constexpr double width = 640, height = 480, diagonal = 800, margin = margin_share * diagonal;
    const Outline outline = rectangle_outline(width, height);
    for (const int corners : {4, 20}) {
        const Polyline cage = automatic_cage(outline, corners);
        expect_cage(cage, outline, corners);
        EXPECT_NEAR(signed_area(cage), (width + 2 * margin) * (height + 2 * margin), 0.005 * width * height);
        for (std::size_t k = 0; k < cage.size(); ++k) {
            // No edge is cut short by a corner that does not bend anything: pieces are about as long as each other.
            const double length = (cage[(k + 1) % cage.size()] - cage[k]).norm();
            const double mean = 2 * (width + height + 4 * margin) / corners;
            EXPECT_NEAR(length, mean, 0.25 * mean);
        }
    }
}

TEST(AutomaticCage, GetsTighterWithMoreCorners) {
    const TriangleMesh figure = reference::figure(1000, 12);
    double last = std::numeric_limits<double>::infinity();
    for (const int corners : {3, 5, 8, 12, 20, 40}) {
        const double area = signed_area(automatic_cage(figure, corners));
        EXPECT_LT(area, 0.97 * last) << corners;
        last = area;
    }
}

TEST(AutomaticCage, MovesAndScalesWithTheSubject) {
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
        const Outline outline = random_outline(seed);
        const Polyline cage = automatic_cage(outline, 14);
        for (const double scale : {1e-6, 0.37, 3.0, 1e5}) {
            const Point shift = scale * Point(-371.3, 911.7);
            const auto map = [&](const Point& p) { return Point(scale * p + shift); };
            const Polyline moved = automatic_cage(mapped(outline, map), 14);
            ASSERT_EQ(moved.size(), cage.size());
            for (std::size_t k = 0; k < cage.size(); ++k) {
                EXPECT_LT((moved[k] - map(cage[k])).norm(), 1e-5 * scale * diagonal_of(outline)) << seed << ' ' << k;
            }
        }
    }
}

TEST(AutomaticCage, OfAMeshIsThatOfItsOutline) {
    for (const std::uint32_t seed : {3U, 5U}) {
        std::mt19937 random(seed);
        Outline outline = outline_of(tests::wavy_polygon(random, {200, 200}, 150, 50));
        outline.components.push_back({tests::wavy_polygon(random, {600, 250}, 100, 30), {}});
        outline.components.front().holes.push_back({{180, 180}, {180, 220}, {220, 220}, {220, 180}});
        TriangleMesh mesh = triangulate(outline);
        const Polyline cage = automatic_cage(mesh, 16);
        expect_cage(cage, outline, 16);
        EXPECT_NEAR(signed_area(cage), signed_area(automatic_cage(outline, 16)), 0.01 * signed_area(cage));
        // Clockwise meshes are meshes too.
        mesh.F.col(0).swap(mesh.F.col(1));
        expect_cage(automatic_cage(mesh, 16), outline, 16);
    }
}

TEST(AutomaticCage, IsTheSameForAnyNumberOfThreads) {
    const Outline outline = random_outline(11);
    set_thread_count(1);
    const Polyline one = automatic_cage(outline, 20);
    set_thread_count(0);
    EXPECT_EQ(one, automatic_cage(outline, 20));
}

TEST(AutomaticCage, BeginsAtTheTop) {
    for (std::uint32_t seed = 1; seed <= 5; ++seed) {
        const Polyline cage = automatic_cage(random_outline(seed), 9);
        for (const Point& corner : cage) EXPECT_GE(corner.y(), cage.front().y());
    }
}

TEST(AutomaticCage, RefusesWhatCannotBe) {
    const Outline outline = rectangle_outline(100, 80);
    const auto refusal = [](const Outline& subject, int corners) {
        return message_of([&] { automatic_cage(subject, corners); });
    };
    for (const int corners : {-1, 0, 2, most_cage_corners + 1}) {
        EXPECT_EQ(refusal(outline, corners),
                  "cage: cannot have " + std::to_string(corners) + " corners (choose 3 to 500)");
    }
    EXPECT_EQ(refusal({}, 20), "cage: there is no subject to draw it around");
    EXPECT_EQ(refusal(outline_of({{3, 4}, {3, 4}, {3, 4}}), 20), "cage: there is no subject to draw it around");
    const double nan = std::numeric_limits<double>::quiet_NaN(), huge = std::numeric_limits<double>::max();
    EXPECT_EQ(refusal(outline_of({{0, 0}, {10, 0}, {nan, 10}}), 20),
              "cage: the subject's coordinates are not all finite");
    EXPECT_EQ(refusal(outline_of({{-huge, 0}, {huge, 0}, {0, 10}}), 20),
              "cage: the subject's coordinates are not all finite");
}

}  // namespace puppetwarp
