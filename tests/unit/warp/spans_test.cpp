#include "scenes.h"

#include <puppetwarp/warp/spans.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace puppetwarp::testing {
namespace {

// How often each pixel of the canvas is held by a triangle, whatever its orientation.
cv::Mat1i coverage(const TriangleMesh& rest, const Eigen::MatrixX2d& moved, const Canvas& canvas) {
    const detail::SnappedMesh mesh(rest, moved, canvas);
    cv::Mat1i count(canvas.height, canvas.width, 0);
    for (int f = 0; f < mesh.triangle_count(); ++f) {
        mesh.for_each_span_of(f, {0, canvas.height}, [&](int row, int first, int last) {
            for (int x = first; x < last; ++x) ++count(row, x);
        });
    }
    return count;
}

int flipped(const TriangleMesh& rest, const Eigen::MatrixX2d& moved) {
    int count = 0;
    for (Eigen::Index f = 0; f < rest.F.rows(); ++f) {
        const Eigen::RowVector2d a = moved.row(rest.F(f, 0)), b = moved.row(rest.F(f, 1)), c = moved.row(rest.F(f, 2));
        count += (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x() <= 0;
    }
    return count;
}

TEST(Spans, HoldEveryCentreOfAWatertightMeshOnce) {
    Random random(1);
    for (int round = 0; round < 400; ++round) {
        const int n = 1 + static_cast<int>(random() % 9), m = 1 + static_cast<int>(random() % 9);
        const TriangleMesh rest = grid_mesh(-5, -5, 37, 29, n, m, random);
        // Grid positions that hit pixel centres and half pixels, too.
        Eigen::MatrixX2d moved = jittered(rest.V, 0.2 * std::min(42.0 / n, 34.0 / m), random);
        if (round % 2 == 0) moved = (moved * 2).array().round() / 2;
        if (flipped(rest, moved) > 0) continue;
        const Canvas canvas{2, 2, 28, 20};  // no outer edge comes so far in
        const cv::Mat1i count = coverage(rest, moved, canvas);
        ASSERT_EQ(cv::countNonZero(count != 1), 0) << "round " << round;
    }
}

// A fan around one point near pixel centres, with thousands of needles and corners up to 1e9 px away.
TEST(Spans, HoldEveryCentreOfAFanOfNeedlesOnce) {
    Random random(2);
    for (const double radius : {40.0, 1e5, 1e9}) {
        for (int round = 0; round < 20; ++round) {
            const int n = 3 + static_cast<int>(random() % 700);
            TriangleMesh rest;
            rest.V.resize(n + 1, 2);
            rest.F.resize(n, 3);
            rest.V.row(n) << uniform(random, 5, 15), uniform(random, 5, 15);
            if (round % 2 == 0) rest.V.row(n) << 7.5, 9.5;
            for (int i = 0; i < n; ++i) {
                const double angle = 2 * M_PI * (i + uniform(random, 0, 0.9)) / n;
                rest.V.row(i) = rest.V.row(n) + radius * Eigen::RowVector2d(std::cos(angle), std::sin(angle));
                rest.F.row(i) << n, i, (i + 1) % n;
            }
            const cv::Mat1i count = coverage(rest, rest.V, {0, 0, 20, 20});
            ASSERT_EQ(cv::countNonZero(count != 1), 0) << "radius " << radius << ", " << n << " needles";
        }
    }
}

TEST(Spans, AgreeWithPointInTriangle) {
    Random random(3);
    for (int round = 0; round < 500; ++round) {
        TriangleMesh rest{Eigen::MatrixX2d(3, 2), Eigen::MatrixX3i(1, 3)};
        rest.F << 0, 1, 2;
        for (int i = 0; i < 3; ++i) rest.V.row(i) << uniform(random, -10, 40), uniform(random, -10, 40);
        const cv::Mat1i count = coverage(rest, rest.V, {0, 0, 30, 30});
        const auto side = [&](int i, int j, const Eigen::RowVector2d& p) {
            const Eigen::RowVector2d a = rest.V.row(i), ab = rest.V.row(j) - a, ap = p - a;
            return (ab.x() * ap.y() - ab.y() * ap.x()) / ab.norm();
        };
        const double sign = side(0, 1, rest.V.row(2)) > 0 ? 1 : -1;
        for (int y = 0; y < 30; ++y) {
            for (int x = 0; x < 30; ++x) {
                const Eigen::RowVector2d p(x + 0.5, y + 0.5);
                const double inside = std::min({sign * side(0, 1, p), sign * side(1, 2, p), sign * side(2, 0, p)});
                if (std::abs(inside) < 1e-4) continue;
                ASSERT_EQ(count(y, x), inside > 0) << "round " << round << " at " << x << ", " << y;
            }
        }
    }
}

TEST(Spans, CentreOnAnEdgeBelongsToTheRightAndToTheLowerSide) {
    TriangleMesh rest{Eigen::MatrixX2d(4, 2), Eigen::MatrixX3i(2, 3)};
    rest.V << 1.5, 1.5, 4.5, 1.5, 4.5, 4.5, 1.5, 4.5;
    rest.F << 0, 1, 2, 0, 2, 3;
    const cv::Mat1i count = coverage(rest, rest.V, {0, 0, 6, 6});
    for (int y = 0; y < 6; ++y) {
        for (int x = 0; x < 6; ++x) EXPECT_EQ(count(y, x), x >= 1 && x < 4 && y >= 1 && y < 4) << x << ", " << y;
    }
}

TEST(Spans, LeaveOutFlippedTrianglesAndThoseWithoutArea) {
    TriangleMesh rest{Eigen::MatrixX2d(3, 2), Eigen::MatrixX3i(1, 3)};
    rest.V << 0, 0, 10, 0, 0, 10;
    rest.F << 0, 1, 2;
    const Canvas canvas{0, 0, 10, 10};
    Eigen::MatrixX2d mirrored = rest.V;
    mirrored.col(0) = 10 - rest.V.col(0).array();
    EXPECT_GT(cv::countNonZero(coverage(rest, rest.V, canvas)), 40);
    EXPECT_EQ(cv::countNonZero(coverage(rest, mirrored, canvas)), 0);
    // Clockwise at rest: what was a flip is none.
    EXPECT_GT(cv::countNonZero(coverage({mirrored, rest.F}, mirrored, canvas)), 40);
    Eigen::MatrixX2d flat = rest.V;
    flat.col(1) = rest.V.col(0);
    EXPECT_EQ(cv::countNonZero(coverage(rest, flat, canvas)), 0);
    flat.setConstant(5.5);
    EXPECT_EQ(cv::countNonZero(coverage(rest, flat, canvas)), 0);
}

TEST(Spans, NoticeOneUncoveredPixel) {
    Random random(4);
    for (const int width : {63, 64, 65, 200}) {
        const Canvas canvas{0, 0, width, 70};
        TriangleMesh rest = grid_mesh(0, 0, width, 70, 3, 3, random);
        EXPECT_TRUE(detail::SnappedMesh(rest, rest.V, canvas).covers_canvas()) << width;
        Eigen::MatrixX2d moved = rest.V;
        moved.row(15) << width - 0.6, 69.4;  // the last pixel's centre lies outside now
        EXPECT_FALSE(detail::SnappedMesh(rest, moved, canvas).covers_canvas()) << width;
    }
}

}  // namespace
}  // namespace puppetwarp::testing
