#include <puppetwarp/mesh/outline.h>

#include "shapes.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>

#include <gmock/gmock.h>
#include <opencv2/imgproc.hpp>

namespace puppetwarp {

using namespace tests;

namespace {

// Slow and plain: whether two segments have a point in common, by exact-enough orientation tests in long double.
int side(const Point& a, const Point& b, const Point& c) {
    const long double d = (static_cast<long double>(b.x()) - a.x()) * (static_cast<long double>(c.y()) - a.y()) -
                          (static_cast<long double>(b.y()) - a.y()) * (static_cast<long double>(c.x()) - a.x());
    return d > 0 ? 1 : d < 0 ? -1 : 0;
}

bool have_common_point(const Point& a, const Point& b, const Point& c, const Point& d) {
    const auto within = [](const Point& p, const Point& q, const Point& r) {
        return (r.array() >= p.array().min(q.array())).all() && (r.array() <= p.array().max(q.array())).all();
    };
    const int s1 = side(a, b, c), s2 = side(a, b, d), s3 = side(c, d, a), s4 = side(c, d, b);
    if (s1 != s2 && s3 != s4) return true;
    return (s1 == 0 && within(a, b, c)) || (s2 == 0 && within(a, b, d)) || (s3 == 0 && within(c, d, a)) ||
           (s4 == 0 && within(c, d, b));
}

// All pairs of edges but neighbours, orientation, and holes in their components.
void expect_valid(const Outline& outline) {
    struct Edge {
        std::size_t polygon, index, count;
        Point a, b;
    };
    std::vector<Edge> edges;
    const std::vector<Polyline> polygons = polygons_of(outline);
    for (std::size_t p = 0; p < polygons.size(); ++p) {
        ASSERT_GE(polygons[p].size(), 3U);
        for (std::size_t k = 0; k < polygons[p].size(); ++k) {
            edges.push_back({p, k, polygons[p].size(), polygons[p][k], polygons[p][(k + 1) % polygons[p].size()]});
            ASSERT_GT((edges.back().b - edges.back().a).norm(), 0);
        }
    }
    for (std::size_t i = 0; i < edges.size(); ++i) {
        for (std::size_t k = i + 1; k < edges.size(); ++k) {
            const Edge &e = edges[i], &f = edges[k];
            const bool neighbours =
                e.polygon == f.polygon && ((e.index + 1) % e.count == f.index || (f.index + 1) % f.count == e.index);
            if (neighbours) continue;
            ASSERT_FALSE(have_common_point(e.a, e.b, f.a, f.b))
                << e.a.transpose() << " - " << e.b.transpose() << " meets " << f.a.transpose() << " - "
                << f.b.transpose();
        }
    }
    for (const OutlineComponent& component : outline.components) {
        EXPECT_GT(signed_area(component.outer), 0);
        const Outline alone{{{component.outer, {}}}};
        for (const Polyline& hole : component.holes) {
            EXPECT_LT(signed_area(hole), 0);
            EXPECT_TRUE(contains(alone, hole.front()));
        }
    }
}

// Every covered pixel's four corners and centre are inside, and no boundary point is inside a covered pixel.
void expect_covers(const Outline& outline, const cv::Mat& matte) {
    for (int j = 0; j < matte.rows; ++j) {
        for (int i = 0; i < matte.cols; ++i) {
            if (matte.at<std::uint8_t>(j, i) == 0) continue;
            for (const Point& p :
                 {Point(i, j), Point(i + 1, j), Point(i, j + 1), Point(i + 1, j + 1), Point(i + 0.5, j + 0.5)}) {
                ASSERT_TRUE(contains(outline, p)) << "pixel " << i << ", " << j << " at " << p.transpose();
            }
        }
    }
    for (const Polyline& polygon : polygons_of(outline)) {
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            const Point a = polygon[k], b = polygon[(k + 1) % polygon.size()];
            const int steps = static_cast<int>((b - a).norm() * 50) + 1;
            for (int step = 0; step < steps; ++step) {
                const Point p = a + (b - a) * (static_cast<double>(step) / steps);
                const int i = static_cast<int>(std::floor(p.x())), j = static_cast<int>(std::floor(p.y()));
                if (i < 0 || j < 0 || i >= matte.cols || j >= matte.rows) continue;
                ASSERT_EQ(matte.at<std::uint8_t>(j, i), 0) << p.transpose();
            }
        }
    }
}

struct Deviation {
    double least = 1e300, most = -1e300, mean = 0, spread = 0;
};

// How far outside the true shape the outline runs, at points a quarter pixel apart.
Deviation deviation_from(const Outline& outline, const Shape& shape) {
    Deviation result;
    double sum = 0, squares = 0;
    int count = 0;
    for (const Polyline& polygon : polygons_of(outline)) {
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            const Point a = polygon[k], b = polygon[(k + 1) % polygon.size()];
            const int steps = static_cast<int>((b - a).norm() * 4) + 1;
            for (int step = 0; step < steps; ++step, ++count) {
                const double out = -shape(a + (b - a) * (static_cast<double>(step) / steps));
                result.least = std::min(result.least, out);
                result.most = std::max(result.most, out);
                sum += out;
                squares += out * out;
            }
        }
    }
    result.mean = sum / count;
    result.spread = std::sqrt(std::max(0.0, squares / count - result.mean * result.mean));
    return result;
}

std::size_t corner_count(const Outline& outline) {
    std::size_t count = 0;
    for (const Polyline& polygon : polygons_of(outline)) count += polygon.size();
    return count;
}

}  // namespace

TEST(TraceOutline, FollowsAnAntialiasedDiscToAFifthOfAPixel) {
    for (const double radius : {6.0, 20.0, 200.0}) {
        for (const double expand : {2.0, 5.5}) {
            SCOPED_TRACE(testing::Message() << "radius " << radius << " expand " << expand);
            const int size = static_cast<int>(2 * radius) + 11;
            const Shape shape = disc({radius + 5.3, radius + 4.8}, radius);
            const Outline outline = trace_outline(picture_of(shape, size, size, false), {0.5, expand, 0});
            const Deviation deviation = deviation_from(outline, shape);
            EXPECT_GT(deviation.least, expand - 0.3);
            EXPECT_LT(deviation.most, expand + 0.15);
            EXPECT_NEAR(deviation.mean, expand, 0.18);
        }
    }
}

TEST(TraceOutline, MakesNoStairsOfHardMasks) {
    for (const double angle : {0.005, 0.01, 0.03, 0.1, 0.3, 0.6, 0.785}) {
        SCOPED_TRACE(angle);
        const Shape shape = turned_rectangle({300, 250}, {240, 80}, angle);
        const Outline outline = trace_outline(picture_of(shape, 600, 500, true));
        const Deviation deviation = deviation_from(outline, shape);
        EXPECT_GT(deviation.least, 2 - 1);  // rounded at the four corners
        EXPECT_LT(deviation.most, 2 + 0.5);
        EXPECT_NEAR(deviation.mean, 2, 0.25);
        EXPECT_LT(deviation.spread, 0.15);
        EXPECT_LT(corner_count(outline), 40U);  // a stair costs two corners each
    }
}

TEST(TraceOutline, FollowsAHardDiscToLessThanAPixel) {
    for (const double radius : {10.0, 47.3, 200.0}) {
        const int size = static_cast<int>(2 * radius) + 11;
        const Shape shape = disc({radius + 5.3, radius + 4.8}, radius);
        const Outline outline = trace_outline(picture_of(shape, size, size, true));
        const Deviation deviation = deviation_from(outline, shape);
        EXPECT_GT(deviation.least, 2 - 0.8) << radius;
        EXPECT_LT(deviation.most, 2 + 0.5) << radius;
        EXPECT_NEAR(deviation.mean, 2, 0.1) << radius;
        EXPECT_LT(deviation.spread, 0.2) << radius;
    }
}

TEST(TraceOutline, SimplifiesAsFarAsAllowed) {
    const Shape shape = disc({205, 205}, 200);
    const cv::Mat matte = picture_of(shape, 410, 410, false);
    const std::size_t fine = corner_count(trace_outline(matte, {0.1, 2, 0}));
    const std::size_t coarse = corner_count(trace_outline(matte, {0.5, 2, 0}));
    // The chord for sagitta s of a circle is sqrt(8 r s): half as many corners for four times the sagitta.
    EXPECT_GT(fine, coarse * 3 / 2);
    EXPECT_LT(coarse, 2 * std::numbers::pi * 200 / 8);
}

TEST(TraceOutline, IsValidAndHoldsEveryVisiblePixelOfRandomPictures) {
    std::mt19937 random(7);
    for (int round = 0; round < 12; ++round) {
        SCOPED_TRACE(round);
        cv::Mat matte = cv::Mat::zeros(90, 120, CV_8U);
        std::uniform_int_distribution<int> x(-5, 125), y(-5, 95), r(1, 16), kind(0, 3), grey(1, 255);
        for (int k = 0; k < 14; ++k) {
            const cv::Point a(x(random), y(random)), b(x(random), y(random));
            const int value = k % 3 ? 255 : grey(random);
            switch (kind(random)) {
                case 0: cv::circle(matte, a, r(random), value, -1, cv::LINE_AA); break;
                case 1: cv::line(matte, a, b, value, 1 + r(random) / 8, round % 2 ? cv::LINE_AA : cv::LINE_8); break;
                case 2: cv::circle(matte, a, r(random), 0, -1, cv::LINE_AA); break;
                default: cv::rectangle(matte, a, a + cv::Point(r(random), r(random)), value, -1); break;
            }
        }
        if (round % 3 == 0) cv::GaussianBlur(matte, matte, {9, 9}, 2.5);
        if (cv::countNonZero(matte) == 0) continue;
        for (const double expand : {0.0, 0.4, 2.0}) {
            for (const double tolerance : {0.5, 5.0}) {
                const Outline outline = trace_outline(matte, {tolerance, expand, 0});
                expect_valid(outline);
                expect_covers(outline, matte);
            }
        }
    }
}

TEST(TraceOutline, HoldsNoise) {
    cv::Mat matte(40, 40, CV_8U);
    for (const double share : {0.02, 0.2, 0.5, 0.9}) {
        std::mt19937 random(3);
        for (int j = 0; j < 40; ++j) {
            for (int i = 0; i < 40; ++i) matte.at<std::uint8_t>(j, i) = random() < share * 4294967296.0 ? 255 : 0;
        }
        for (const double expand : {0.0, 2.0}) {
            const Outline outline = trace_outline(matte, {0.5, expand, 0});
            expect_valid(outline);
            expect_covers(outline, matte);
        }
    }
}

TEST(TraceOutline, TakesThePicturesThatAreHardlyAny) {
    cv::Mat line = cv::Mat::zeros(9, 30, CV_8U);
    line.row(4).setTo(255);
    cv::Mat speck = cv::Mat::zeros(9, 9, CV_8U);
    speck.at<std::uint8_t>(0, 8) = 1;
    cv::Mat board(12, 12, CV_8U);
    for (int k = 0; k < 144; ++k) board.at<std::uint8_t>(k / 12, k % 12) = (k / 12 + k) % 2 ? 255 : 0;
    const std::vector<cv::Mat> pictures{cv::Mat(1, 1, CV_8U, cv::Scalar(255)),
                                        cv::Mat(3, 3, CV_8U, cv::Scalar(255)),
                                        cv::Mat(1, 3, CV_8U, cv::Scalar(7)),
                                        line,
                                        cv::Mat(line.t()),
                                        speck,
                                        board,
                                        cv::Mat(50, 20, CV_8U, cv::Scalar(255))};
    for (const cv::Mat& matte : pictures) {
        for (const double expand : {0.0, 0.5, 2.0, 300.0}) {
            const Outline outline = trace_outline(matte, {0.5, expand, 0});
            expect_valid(outline);
            expect_covers(outline, matte);
        }
    }
    // Grown by far more than its size, anything is nearly a disc.
    EXPECT_NEAR(area_of(trace_outline(pictures[0], {0.5, 300, 0})), std::numbers::pi * 300.5 * 300.5, 2000);
}

TEST(TraceOutline, DoesNotDependOnTheDepth) {
    const cv::Mat matte = picture_of(disc({30.3, 29.7}, 22), 60, 60, false);
    cv::Mat wide, real;
    matte.convertTo(wide, CV_16U, 257);
    matte.convertTo(real, CV_32F, 1 / 255.0);
    const Polyline expected = trace_outline(matte).components[0].outer;
    EXPECT_EQ(trace_outline(wide).components[0].outer, expected);
    EXPECT_EQ(trace_outline(real).components[0].outer, expected);
}

TEST(TraceOutline, GivesTheSameForAnyNumberOfThreads) {
    cv::Mat matte = cv::Mat::zeros(500, 400, CV_8U);
    std::mt19937 random(5);
    for (int k = 0; k < 60; ++k) {
        cv::circle(matte, cv::Point(static_cast<int>(random() % 400), static_cast<int>(random() % 500)),
                   static_cast<int>(random() % 30), 255, -1, cv::LINE_AA);
    }
    set_thread_count(1);
    const std::vector<Polyline> one = polygons_of(trace_outline(matte, {0.5, 0.3, 0}));
    set_thread_count(4);
    const std::vector<Polyline> four = polygons_of(trace_outline(matte, {0.5, 0.3, 0}));
    set_thread_count(0);
    EXPECT_EQ(one, four);
}

TEST(TraceOutline, KnowsHolesIslandsAndWhatToFill) {
    cv::Mat matte = cv::Mat::zeros(200, 200, CV_8U);
    cv::circle(matte, {100, 100}, 90, 255, -1, cv::LINE_AA);
    cv::circle(matte, {90, 100}, 50, 0, -1, cv::LINE_AA);
    cv::circle(matte, {90, 100}, 20, 255, -1, cv::LINE_AA);
    cv::circle(matte, {165, 100}, 8, 0, -1, cv::LINE_AA);
    const Outline all = trace_outline(matte);
    ASSERT_EQ(all.components.size(), 2U);
    EXPECT_EQ(all.components[0].holes.size(), 2U);
    EXPECT_EQ(all.components[1].holes.size(), 0U);
    // pi 6^2 is about 113, pi 48^2 about 7238.
    const Outline some = trace_outline(matte, {0.5, 2, 200});
    ASSERT_EQ(some.components.size(), 2U);
    EXPECT_EQ(some.components[0].holes.size(), 1U);
    const Outline none = trace_outline(matte, {0.5, 2, 8000});
    ASSERT_EQ(none.components.size(), 1U);  // the island goes with the hole it was in
    EXPECT_EQ(none.components[0].holes.size(), 0U);
}

TEST(TraceOutline, JoinsPartsWhoseGrowthMeets) {
    cv::Mat matte = cv::Mat::zeros(60, 120, CV_8U);
    matte(cv::Rect(20, 20, 20, 20)).setTo(255);
    matte(cv::Rect(46, 20, 20, 20)).setTo(255);  // 6 px apart
    EXPECT_EQ(trace_outline(matte, {0.5, 2.5, 0}).components.size(), 2U);
    EXPECT_EQ(trace_outline(matte, {0.5, 3.5, 0}).components.size(), 1U);
}

TEST(TraceOutline, GrowsOnlyWhereCoverageAsksForIt) {
    const Shape shape = disc({100, 100}, 50);
    cv::Mat matte = picture_of(shape, 200, 200, false);
    matte(cv::Rect(150, 90, 30, 20)).setTo(10);  // a shadow on the right
    const Outline outline = trace_outline(matte);
    expect_covers(outline, matte);
    for (const Point& point : outline.components[0].outer) {
        if (point.x() < 130) {
            EXPECT_NEAR(-shape(point), 2, 0.3) << point.transpose();
        }
        EXPECT_LT(point.x(), 180 + 1.5);
    }
}

TEST(TraceOutline, RefusesWhatHasNothingVisible) {
    EXPECT_THROW(trace_outline(cv::Mat::zeros(5, 5, CV_8U)), InvalidInput);
    EXPECT_THROW(trace_outline(cv::Mat()), InvalidInput);
    EXPECT_THROW(trace_outline(cv::Mat(2, 2, CV_32F, cv::Scalar(std::nan("")))), InvalidInput);
    const cv::Mat full(5, 5, CV_8U, cv::Scalar(255));
    EXPECT_THROW(trace_outline(full, {0, 2, 0}), InvalidInput);
    EXPECT_THROW(trace_outline(full, {0.5, -1, 0}), InvalidInput);
    EXPECT_THROW(trace_outline(full, {0.5, std::nan(""), 0}), InvalidInput);
    EXPECT_THROW(trace_outline(full, {0.5, 2, -1}), InvalidInput);
}

TEST(Outline, KnowsAreaInsideAndNearestPoint) {
    const Outline rectangle = rectangle_outline(30, 20);
    EXPECT_EQ(signed_area(rectangle.components[0].outer), 600);
    Outline ring = rectangle;
    ring.components[0].holes.push_back({{10, 5}, {10, 15}, {20, 15}, {20, 5}});
    EXPECT_EQ(signed_area(ring.components[0].holes[0]), -100);
    EXPECT_TRUE(contains(ring, {5, 5}));
    EXPECT_FALSE(contains(ring, {15, 10}));
    EXPECT_FALSE(contains(ring, {-1, 10}));
    EXPECT_EQ(nearest_boundary_point(ring, {12, 11}), Point(10, 11));
    EXPECT_EQ(nearest_boundary_point(ring, {-3, -4}), Point(0, 0));
    EXPECT_EQ(nearest_boundary_point(ring, {40, 7}), Point(30, 7));
}

}  // namespace puppetwarp
