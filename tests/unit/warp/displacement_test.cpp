// The map that a warp draws with, against triangles tried one by one.
#include "scenes.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/warp/displacement.h>

#include <Eigen/Dense>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

namespace puppetwarp::testing {
namespace {

// Where a point lies in triangle `f` of the moved mesh at rest; nothing outside of it. Near edges nobody can say.
struct Found {
    bool ambiguous = false;
    std::optional<Point> place;
};

Found place_in(const TriangleMesh& rest, const Eigen::MatrixX2d& moved, Eigen::Index f, const Point& p,
               BackFaces back_faces = BackFaces::hide) {
    Eigen::Matrix2d to, from;
    for (int k = 0; k < 2; ++k) {
        to.col(k) = moved.row(rest.F(f, k + 1)) - moved.row(rest.F(f, 0));
        from.col(k) = rest.V.row(rest.F(f, k + 1)) - rest.V.row(rest.F(f, 0));
    }
    const double orientation = to.determinant() * from.determinant();
    if (orientation == 0 || (orientation < 0 && back_faces == BackFaces::hide)) return {};
    const Eigen::Vector2d w = to.inverse() * (p - moved.row(rest.F(f, 0)).transpose());
    const double least = std::min({w.x(), w.y(), 1 - w.x() - w.y()});
    Found found;
    found.ambiguous = std::abs(least) < 1e-4;
    if (least > 0) found.place = rest.V.row(rest.F(f, 0)).transpose() + from * w;
    return found;
}

std::optional<Point> place_of(const DisplacementMap& map, int x, int y) {
    const auto& d = map.displacement.at<cv::Vec3f>(y, x);
    if (std::isnan(d[0]) || std::isnan(d[1])) return std::nullopt;
    return Point(map.plane.place(x, y) + Point(d[0], d[1]));
}

// Two copies of a mesh, the second one after, and so over, the first.
TriangleMesh two_sheets(const TriangleMesh& mesh) {
    TriangleMesh two;
    two.V.resize(2 * mesh.V.rows(), 2);
    two.V << mesh.V, mesh.V;
    two.F.resize(2 * mesh.F.rows(), 3);
    two.F << mesh.F, mesh.F.array() + static_cast<int>(mesh.V.rows());
    return two;
}

class MapOfWarp : public ::testing::TestWithParam<double> {};

TEST_P(MapOfWarp, HoldsThePlaceOfTheFrontmostTriangle) {
    Random random(31);
    const double scale = GetParam();
    for (int round = 0; round < 8; ++round) {
        const Image image = random_image(40, 30, CV_8UC3, random);
        const TriangleMesh rest = two_sheets(grid_mesh(-1, -1, 41, 31, 4, 3, random));
        Eigen::MatrixX2d moved = jittered(rest.V, 4, random);
        moved.bottomRows(moved.rows() / 2).array() += 11.3;
        moved *= scale;
        const Canvas canvas{-7, -4, 60, 50};
        const DisplacementMap map = displacement_map(image, rest, moved, {Interpolation::bicubic, canvas}, scale);
        ASSERT_EQ(map.displacement.size(), cv::Size(60, 50));
        ASSERT_EQ(map.plane.source_width, 40);
        int shown = 0, empty = 0;
        for (int y = 0; y < 50; ++y) {
            for (int x = 0; x < 60; ++x) {
                Found front;
                for (Eigen::Index f = 0; f < rest.F.rows(); ++f) {
                    const Found found = place_in(rest, moved, f, Point(canvas.x + x + 0.5, canvas.y + y + 0.5));
                    front.ambiguous |= found.ambiguous;
                    if (found.place) front.place = found.place;
                }
                if (front.ambiguous) continue;
                const auto place = place_of(map, x, y);
                ASSERT_EQ(place.has_value(), front.place.has_value()) << x << ", " << y;
                ASSERT_EQ(map.displacement.at<cv::Vec3f>(y, x)[2], place ? 1 : 0);
                (place ? shown : empty)++;
                if (!place) continue;
                ASSERT_NEAR(place->x(), front.place->x(), 1e-4) << x << ", " << y;
                ASSERT_NEAR(place->y(), front.place->y(), 1e-4) << x << ", " << y;
            }
        }
        ASSERT_GT(shown, 500);
        ASSERT_GT(empty, 100);
    }
}

// Sheets folded over themselves and each other, whose depths have nothing to do with their numbering.
TEST(Displacement, IsOfTheTriangleThatDepthsAndBackFacesBringToTheFront) {
    Random random(36);
    for (int round = 0; round < 12; ++round) {
        const Image image = random_image(40, 30, CV_8UC3, random);
        const TriangleMesh rest = two_sheets(grid_mesh(-1, -1, 41, 31, 4, 3, random));
        const Eigen::MatrixX2d moved = jittered(rest.V, 9, random);
        WarpOptions options;
        options.canvas = {-12, -10, 64, 50};
        options.back_faces = round % 2 == 0 ? BackFaces::show : BackFaces::hide;
        options.depth.resize(rest.V.rows());
        for (double& depth : options.depth) depth = uniform(random, -1, 1);
        const DisplacementMap map = displacement_map(image, rest, moved, options);
        int compared = 0, not_the_last = 0;
        for (int y = 0; y < options.canvas.height; ++y) {
            for (int x = 0; x < options.canvas.width; ++x) {
                bool ambiguous = false;
                std::optional<Point> front, last;
                double nearest = 0;
                for (Eigen::Index f = 0; f < rest.F.rows(); ++f) {
                    const Point centre(options.canvas.x + x + 0.5, options.canvas.y + y + 0.5);
                    const Found found = place_in(rest, moved, f, centre, options.back_faces);
                    ambiguous |= found.ambiguous;
                    if (!found.place) continue;
                    const double depth =
                        options.depth(rest.F(f, 0)) + options.depth(rest.F(f, 1)) + options.depth(rest.F(f, 2));
                    if (!front || depth > nearest) {
                        front = found.place;
                        nearest = depth;
                    }
                    last = found.place;
                }
                if (ambiguous) continue;
                const auto place = place_of(map, x, y);
                ASSERT_EQ(place.has_value(), front.has_value()) << x << ", " << y;
                if (!place) continue;
                ASSERT_LT((*place - *front).norm(), 1e-4) << x << ", " << y;
                ++compared;
                not_the_last += (*front - *last).norm() > 1 ? 1 : 0;
            }
        }
        ASSERT_GT(compared, 1000);
        ASSERT_GT(not_the_last, 100);
    }
}

INSTANTIATE_TEST_SUITE_P(Scales, MapOfWarp, ::testing::Values(1.0, 0.7, 1.25));

TEST(Displacement, WholePixelMovesAreWholeNumbers) {
    Random random(32);
    const Image image = random_image(40, 30, CV_16UC3, random);
    const TriangleMesh rest = grid_mesh(0, 0, 40, 30, 3, 3, random);
    const Eigen::MatrixX2d moved = jittered(rest.V.rowwise() + Eigen::RowVector2d(7, -3), 1e-6, random);
    const DisplacementMap map = displacement_map(image, rest, moved);
    for (int y = 0; y < 30; ++y) {
        for (int x = 0; x < 40; ++x) {
            const auto& d = map.displacement.at<cv::Vec3f>(y, x);
            if (x >= 7 && y < 27) {
                ASSERT_EQ(d, cv::Vec3f(-7, 3, 1)) << x << ", " << y;
            } else {
                ASSERT_TRUE(std::isnan(d[0]) && std::isnan(d[1]) && d[2] == 0) << x << ", " << y;
            }
        }
    }
}

// Of 48 MP pictures moved by hundreds of pixels nothing is lost.
TEST(Displacement, KeepsItsDigitsFarFromTheOrigin) {
    const Image image{cv::Mat(1, 1, CV_8UC3), {}};
    TriangleMesh rest{Eigen::MatrixX2d(3, 2), Eigen::MatrixX3i(1, 3)};
    rest.V << 7000, 5000, 8001, 5003, 7011, 6000;
    rest.F << 0, 1, 2;
    Eigen::MatrixX2d moved = rest.V.rowwise() + Eigen::RowVector2d(300.25, -500.5);
    moved(1, 0) += 40.125;
    const Canvas canvas{7300, 4600, 300, 300};
    const DisplacementMap map = displacement_map(image, rest, moved, {Interpolation::bicubic, canvas});
    int compared = 0;
    for (int y = 0; y < 300; ++y) {
        for (int x = 0; x < 300; ++x) {
            const Found found = place_in(rest, moved, 0, Point(canvas.x + x + 0.5, canvas.y + y + 0.5));
            if (!found.place || found.ambiguous) continue;
            ++compared;
            ASSERT_LT((*place_of(map, x, y) - *found.place).norm(), 5e-5);
        }
    }
    ASSERT_GT(compared, 10000);
}

TEST(Displacement, OfLayersTheOneIsTakenThatShowsMost) {
    Random random(33);
    // Alpha is 0.6 left of the middle and 0.2 right of it; the front sheet is moved to the right by 10.
    Image image{cv::Mat(20, 40, CV_32FC2, cv::Scalar(0.5, 0.6)), {}};
    image.pixels.colRange(20, 40).setTo(cv::Scalar(0.5, 0.2));
    const TriangleMesh rest = two_sheets(grid_mesh(0, 0, 40, 20, 2, 2, random));
    Eigen::MatrixX2d moved = rest.V;
    moved.bottomRows(moved.rows() / 2).col(0).array() += 10;
    const DisplacementMap map = displacement_map(image, rest, moved);
    const auto displacement = [&](int x) { return map.displacement.at<cv::Vec3f>(10, x)[0]; };
    EXPECT_EQ(displacement(5), 0);     // the back alone
    EXPECT_EQ(displacement(15), -10);  // 0.6 before 0.6: the back keeps 0.4 of it
    EXPECT_EQ(displacement(25), -10);  // 0.6 before 0.2
    EXPECT_EQ(displacement(35), -10);  // 0.2 before 0.2: the back keeps 0.16
    EXPECT_EQ(displacement_map(image, rest, 2 * rest.V - moved).displacement.at<cv::Vec3f>(10, 12)[0], 0)
        << "0.2 before 0.6: the back keeps 0.48";
}

TEST(Displacement, AMatteSaysHowMuchIsLeftOfAllLayers) {
    Random random(34);
    const Image image{cv::Mat(20, 40, CV_8UC4, cv::Scalar(9, 9, 9, 255)), {}};
    cv::Mat matte(20, 40, CV_8UC1, cv::Scalar(51));
    matte.colRange(20, 40).setTo(cv::Scalar(0));
    const TriangleMesh rest = two_sheets(grid_mesh(0, 0, 40, 20, 2, 2, random));
    Eigen::MatrixX2d moved = rest.V;
    moved.bottomRows(moved.rows() / 2).col(0).array() += 10;
    const DisplacementRows rows(image, matte, rest, moved);
    cv::Mat row(1, 40, CV_32FC3);
    rows.fill(10, row);
    EXPECT_NEAR(row.at<cv::Vec3f>(0, 5)[2], 0.2, 1e-6);
    EXPECT_NEAR(row.at<cv::Vec3f>(0, 15)[2], 0.2 + 0.8 * 0.2, 1e-6);
    EXPECT_NEAR(row.at<cv::Vec3f>(0, 25)[2], 0.2, 1e-6);
    EXPECT_EQ(row.at<cv::Vec3f>(0, 35)[2], 0);
}

TEST(Displacement, IsTheSameForAnyThreadsAndAnyDivision) {
    Random random(35);
    const int before = thread_count();
    const Image image = random_image(90, 130, CV_8UC4, random, Alpha::patches);
    const TriangleMesh rest = two_sheets(grid_mesh(-2, -2, 92, 132, 7, 9, random));
    const Eigen::MatrixX2d moved = jittered(rest.V, 9, random);
    const cv::Mat whole = displacement_map(image, rest, moved).displacement;
    for (const int threads : {1, 2, 7}) {
        set_thread_count(threads);
        const DisplacementRows rows(image, {}, rest, moved);
        cv::Mat pieces(130, 90, CV_32FC3);
        for (int first = 0; first < 130; first += 37) {
            cv::Mat piece = pieces.rowRange(first, std::min(first + 37, 130));
            rows.fill(first, piece);
        }
        EXPECT_TRUE(same_bytes(pieces, whole)) << threads;
    }
    set_thread_count(before);
}

TEST(Displacement, RefusesWhatWarpRefuses) {
    Random random(36);
    const Image image = random_image(8, 8, CV_8UC3, random);
    const TriangleMesh rest = grid_mesh(0, 0, 8, 8, 1, 1, random);
    Eigen::MatrixX2d moved = rest.V;
    moved(2, 1) = std::numeric_limits<double>::infinity();
    EXPECT_THROW(displacement_map(image, rest, moved), InvalidInput);
    EXPECT_THROW(displacement_map(image, rest, rest.V, {Interpolation::nearest, {0, 0, 65536, 65536}}), InvalidInput);
}

}  // namespace
}  // namespace puppetwarp::testing
