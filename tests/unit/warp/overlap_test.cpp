// Triangles over each other: who is in front, what shows through, what the back of a fold looks like.

#include "reference.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/warp/painters_order.h>
#include <puppetwarp/warp/warp_job.h>

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

namespace puppetwarp::testing {
namespace {

constexpr double pi = 3.14159265358979323846;

std::vector<int> order_of(const TriangleMesh& mesh, const Eigen::VectorXd& depth) {
    const Eigen::VectorXi order = painters_order(mesh, depth);
    return {order.begin(), order.end()};
}

TEST(PaintersOrder, GoesByTheMeanDepthOfTheCornersAndThenByIndex) {
    TriangleMesh mesh;
    mesh.V.setZero(6, 2);
    mesh.F.resize(4, 3);
    mesh.F << 0, 1, 2, 3, 4, 5, 1, 2, 0, 2, 3, 4;
    Eigen::VectorXd depth(6);
    depth << 3, 1, 2, 0, 1, -1;  // means 2, 0, 2, 1
    EXPECT_EQ(order_of(mesh, depth), (std::vector{1, 3, 0, 2}));
    EXPECT_EQ(order_of(mesh, -depth), (std::vector{0, 2, 3, 1}));
    EXPECT_EQ(order_of(mesh, {}), (std::vector{0, 1, 2, 3}));
    EXPECT_EQ(order_of(mesh, Eigen::VectorXd::Constant(6, 0.1)), (std::vector{0, 1, 2, 3}));
    depth *= 1e308 / 3;
    EXPECT_EQ(order_of(mesh, depth), (std::vector{1, 3, 0, 2}));
}

// In floating point (a + b) + c is not (b + c) + a: a tie must stay a tie.
TEST(PaintersOrder, DoesNotDependOnWhichCornerATriangleNamesFirst) {
    Random random(1);
    TriangleMesh mesh;
    mesh.V.setZero(3, 2);
    mesh.F.resize(6, 3);
    mesh.F << 0, 1, 2, 1, 2, 0, 2, 0, 1, 0, 2, 1, 2, 1, 0, 1, 0, 2;
    for (int round = 0; round < 200; ++round) {
        const Eigen::Vector3d depth(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
        ASSERT_EQ(order_of(mesh, depth), (std::vector{0, 1, 2, 3, 4, 5}));
    }
}

TEST(PaintersOrder, RefusesDepthsThatAreNone) {
    Random random(2);
    const TriangleMesh mesh = grid_mesh(0, 0, 8, 8, 1, 1, random);
    const Image image = random_image(8, 8, CV_8UC3, random);
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        WarpOptions options;
        options.depth = Eigen::Vector4d(0, 1, bad, 0);
        EXPECT_THROW(warp(image, mesh, mesh.V, options), InvalidInput);
    }
    WarpOptions options;
    options.depth = Eigen::Vector3d(0, 1, 2);
    EXPECT_THROW(warp(image, mesh, mesh.V, options), InvalidInput);
}

// A strip bent to a ring whose ends lie over each other; no triangle is turned over. Red where it begins, blue where it
// ends, green between.
struct Ring {
    static constexpr int length = 160, width = 16;

    Image image{cv::Mat(width, length, CV_8UC4, cv::Scalar(0, 255, 0, 255)), {}};
    TriangleMesh rest;
    WarpOptions options;

    explicit Ring(Random& random) : rest(grid_mesh(-1, -1, length + 1, width + 1, 40, 4, random)) {
        image.pixels.colRange(0, length / 4).setTo(cv::Scalar(255, 0, 0, 255));
        image.pixels.colRange(3 * length / 4, length).setTo(cv::Scalar(0, 0, 255, 255));
        options.interpolation = Interpolation::nearest;
        options.canvas = {-45, -45, 90, 90};
        options.depth = rest.V.col(0) / length;
    }

    // \param turns  how often it goes round.
    Eigen::MatrixX2d bent(double turns) const {
        Eigen::MatrixX2d moved(rest.V.rows(), 2);
        for (Eigen::Index v = 0; v < moved.rows(); ++v) {
            const double angle = 2 * pi * turns * rest.V(v, 0) / length, radius = 40 - rest.V(v, 1);
            moved.row(v) << radius * std::cos(angle), radius * std::sin(angle);
        }
        return moved;
    }

    Image drawn(double turns) const { return warp(image, rest, bent(turns), options); }
};

// Pixels of a colour that are opaque.
int count(const Image& image, const cv::Vec4b& colour) {
    int found = 0;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) found += image.pixels.at<cv::Vec4b>(y, x) == colour ? 1 : 0;
    }
    return found;
}

const cv::Vec4b red(255, 0, 0, 255), blue(0, 0, 255, 255);

TEST(Overlap, TheNearerEndOfAFoldedStripIsOnTop) {
    Random random(3);
    Ring ring(random);
    const double turns = 1.15;
    const Image end_in_front = ring.drawn(turns);
    ring.options.depth *= -1;
    const Image start_in_front = ring.drawn(turns);
    // Where both ends lie, whichever is in front shows; elsewhere the pictures are the same.
    const double shared_area = 2 * pi * 0.15 * (40 * 40 - 24 * 24) / 2;
    int differing = 0;
    for (int y = 0; y < 90; ++y) {
        for (int x = 0; x < 90; ++x) {
            const auto a = end_in_front.pixels.at<cv::Vec4b>(y, x), b = start_in_front.pixels.at<cv::Vec4b>(y, x);
            if (a == b) continue;
            ++differing;
            ASSERT_EQ(a, blue) << x << ", " << y;
            ASSERT_EQ(b, red) << x << ", " << y;
        }
    }
    EXPECT_NEAR(differing, shared_area, 0.1 * shared_area);
}

TEST(Overlap, NumberingChangesNothingButTies) {
    Random random(4);
    Ring ring(random);
    for (Eigen::Index v = 0; v < ring.options.depth.size(); ++v) ring.options.depth(v) += uniform(random, 0, 0.1);
    const Image expected = ring.drawn(1.2);
    for (int round = 0; round < 5; ++round) {
        Ring other = ring;
        std::vector<int> vertices(static_cast<std::size_t>(ring.rest.V.rows())),
            faces(static_cast<std::size_t>(ring.rest.F.rows()));
        std::iota(vertices.begin(), vertices.end(), 0);
        std::iota(faces.begin(), faces.end(), 0);
        std::shuffle(vertices.begin(), vertices.end(), random);
        std::shuffle(faces.begin(), faces.end(), random);
        for (Eigen::Index v = 0; v < ring.rest.V.rows(); ++v) {
            other.rest.V.row(vertices[static_cast<std::size_t>(v)]) = ring.rest.V.row(v);
            other.options.depth(vertices[static_cast<std::size_t>(v)]) = ring.options.depth(v);
        }
        for (Eigen::Index f = 0; f < ring.rest.F.rows(); ++f) {
            for (int k = 0; k < 3; ++k) {
                other.rest.F(faces[static_cast<std::size_t>(f)], k) =
                    vertices[static_cast<std::size_t>(ring.rest.F(f, k))];
            }
        }
        ASSERT_TRUE(same_bytes(other.drawn(1.2).pixels, expected.pixels));
    }
}

// While the end of the strip slides over its start, a pixel that the end covers shows the end in every frame: nothing
// changes sides because something moved.
TEST(Overlap, NothingPopsInASlowDrag) {
    Random random(5);
    const Ring ring(random);
    int before = 0;
    for (int frame = 0; frame <= 100; ++frame) {
        const double turns = 1.02 + 0.002 * frame;
        const Image picture = ring.drawn(turns);
        for (int y = 0; y < 90; ++y) {
            for (int x = 0; x < 90; ++x) {
                const double px = x - 45 + 0.5, py = y - 45 + 0.5, radius = std::hypot(px, py);
                const double angle = std::atan2(py, px) + (py < 0 ? 2 * pi : 0);
                // Well inside the end: three quarters of the strip to its end, once round.
                const bool inside = radius > 25 && radius < 39 && angle + 2 * pi < 2 * pi * turns - 0.05;
                if (inside) {
                    ASSERT_EQ(picture.pixels.at<cv::Vec4b>(y, x), blue) << "frame " << frame;
                }
            }
        }
        const int now = count(picture, red);
        if (frame > 0) {
            // The overlap grows by 0.0126 of a radian, no more than that goes.
            EXPECT_LE(now, before + 8) << "frame " << frame;
            EXPECT_GE(now, before - 14) << "frame " << frame;
        }
        before = now;
    }
}

TEST(Overlap, DepthsChangeNothingWhereNothingOverlaps) {
    Random random(6);
    for (const int type : {CV_8UC3, CV_8UC4, CV_16UC4, CV_32FC1}) {
        for (int round = 0; round < 20; ++round) {
            const Image image = random_image(60, 50, type, random, Alpha::patches);
            const TriangleMesh rest = grid_mesh(-2, -2, 62, 52, 6, 5, random);
            const Eigen::MatrixX2d moved = jittered(rest.V, 2, random);
            WarpOptions options;
            const Image plain = warp(image, rest, moved, options);
            options.depth.resize(rest.V.rows());
            for (double& depth : options.depth) depth = uniform(random, -1, 1);
            ASSERT_TRUE(same_bytes(warp(image, rest, moved, options).pixels, plain.pixels));
        }
    }
}

// Every layer of a picture that is opaque everywhere hides the others: no crack where layers of one mesh meet.
TEST(Overlap, LayersOfOneMeshMeetWithoutACrack) {
    Random random(7);
    const Image image{cv::Mat(40, 40, CV_8UC3, cv::Scalar(10, 200, 90)), {}};
    for (int round = 0; round < 300; ++round) {
        const TriangleMesh rest = grid_mesh(-2, -2, 42, 42, 5, 5, random);
        Eigen::MatrixX2d moved = rest.V;
        for (int j = 1; j < 5; ++j) {
            for (int i = 1; i < 5; ++i) {  // the border stays: inside, triangles fold over each other at will
                moved(6 * j + i, 0) += uniform(random, -9, 9);
                moved(6 * j + i, 1) += uniform(random, -9, 9);
            }
        }
        WarpOptions options;
        options.interpolation = Interpolation::bilinear;
        options.depth = Eigen::VectorXd::Random(rest.V.rows());
        options.back_faces = round % 3 == 0 ? BackFaces::show : BackFaces::hide;
        const Image drawn = warp(image, rest, moved, options);
        ASSERT_EQ(drawn.pixels.type(), image.pixels.type()) << "round " << round;
        ASSERT_TRUE(same_bytes(drawn.pixels, image.pixels)) << "round " << round;
    }
}

TEST(Overlap, TranslucentLayersAndBackFacesAreLikeTheReference) {
    Random random(8);
    for (const int type : {CV_8UC4, CV_8UC2, CV_16UC4, CV_32FC4}) {
        for (int round = 0; round < 8; ++round) {
            const Image image = random_image(30, 24, type, random, Alpha::patches);
            const TriangleMesh rest = grid_mesh(-2, -2, 32, 26, 4, 3, random);
            const Eigen::MatrixX2d moved = jittered(rest.V, 7, random);
            WarpOptions options;
            options.canvas = {-8, -8, 46, 40};
            options.back_faces = round % 2 == 0 ? BackFaces::show : BackFaces::hide;
            options.depth.resize(rest.V.rows());
            for (double& depth : options.depth) depth = uniform(random, -1, 1);
            const Image result = warp(image, rest, moved, options);
            const Reference reference(image, rest, moved, options);
            // Each stored layer is rounded once, and four may lie over each other.
            const double most = 4 * (image.pixels.depth() == CV_8U    ? 1.0
                                     : image.pixels.depth() == CV_16U ? 16.0
                                                                      : 2e-5);
            for (int y = 0; y < result.height(); ++y) {
                for (int x = 0; x < result.width(); ++x) {
                    const Premultiplied expected = reference.at(x, y);
                    if (expected[4] != 0) continue;
                    const double alpha = value_at(result, x, y, result.alpha_channel()) / result.full_value();
                    ASSERT_NEAR(alpha, expected[3], most / result.full_value()) << "round " << round;
                    for (int c = 0; c < (image.pixels.channels() <= 2 ? 1 : 3); ++c) {
                        ASSERT_NEAR(value_at(result, x, y, c) * alpha, expected[static_cast<std::size_t>(c)], 2 * most)
                            << "round " << round << " at " << x << ", " << y;
                    }
                }
            }
        }
    }
}

TEST(BackFaces, ShowThePictureMirrored) {
    Random random(9);
    const Image image = random_image(40, 30, CV_8UC4, random, Alpha::opaque);
    const TriangleMesh rest = grid_mesh(-2, -2, 42, 32, 4, 3, random);
    Eigen::MatrixX2d moved = rest.V;
    moved.col(0) = 40 - rest.V.col(0).array();
    WarpOptions options;
    EXPECT_EQ(cv::countNonZero(warp(image, rest, moved, options).pixels.reshape(1)), 0);
    for (const Interpolation interpolation :
         {Interpolation::nearest, Interpolation::bilinear, Interpolation::bicubic}) {
        options.interpolation = interpolation;
        options.back_faces = BackFaces::show;
        const Image shown = warp(image, rest, moved, options);
        for (int y = 0; y < 30; ++y) {
            for (int x = 0; x < 40; ++x) {
                ASSERT_EQ(shown.pixels.at<cv::Vec4b>(y, x), image.pixels.at<cv::Vec4b>(y, 39 - x)) << x << ", " << y;
            }
        }
    }
    // Clockwise at rest: what is turned over lies counterclockwise.
    const TriangleMesh clockwise{moved, rest.F};
    options.back_faces = BackFaces::hide;
    EXPECT_TRUE(same_bytes(warp(image, clockwise, moved, options).pixels, image.pixels));
    EXPECT_EQ(cv::countNonZero(warp(image, clockwise, rest.V, options).pixels.reshape(1)), 0);
}

// A sheet folded over like a page, the right half onto the left.
TEST(BackFaces, OfAPageAreInFrontOrBehindByDepth) {
    Random random(10);
    Image image{cv::Mat(20, 40, CV_8UC3, cv::Scalar(255, 0, 0)), {}};
    image.pixels.colRange(20, 40).setTo(cv::Scalar(0, 0, 255));
    const TriangleMesh rest = grid_mesh(0, 0, 40, 20, 8, 4, random);
    Eigen::MatrixX2d moved = rest.V;
    moved.col(0) = 20 - (rest.V.col(0).array() - 20).abs();
    WarpOptions options;
    options.interpolation = Interpolation::nearest;
    options.canvas = {0, 0, 20, 20};
    options.depth = rest.V.col(0);
    EXPECT_EQ(warp(image, rest, moved, options).pixels.at<cv::Vec3b>(10, 10), cv::Vec3b(255, 0, 0));
    options.back_faces = BackFaces::show;
    EXPECT_EQ(cv::norm(warp(image, rest, moved, options).pixels, cv::Mat(20, 20, CV_8UC3, cv::Scalar(0, 0, 255)),
                       cv::NORM_INF),
              0);
    options.depth *= -1;
    EXPECT_EQ(cv::norm(warp(image, rest, moved, options).pixels, cv::Mat(20, 20, CV_8UC3, cv::Scalar(255, 0, 0)),
                       cv::NORM_INF),
              0);
}

// The fold lies at 20.4: both sides of the page, together or alone, cover two fifths of the pixels there.
TEST(BackFaces, EndWithinAPixelLikeFronts) {
    Random random(12);
    const Image image{cv::Mat(20, 40, CV_8UC3, cv::Scalar(90, 60, 30)), {}};
    const TriangleMesh rest = grid_mesh(0, 0, 40, 20, 8, 4, random);
    Eigen::MatrixX2d moved = rest.V;
    moved.col(0) = 20.4 - (rest.V.col(0).array() - 20).abs();
    for (const BackFaces back_faces : {BackFaces::hide, BackFaces::show}) {
        for (const double sign : {-1.0, 1.0}) {
            WarpOptions options;
            options.canvas = {0, 0, 30, 20};
            options.back_faces = back_faces;
            options.depth = sign * rest.V.col(0);
            const Image folded = warp(image, rest, moved, options);
            ASSERT_EQ(folded.pixels.type(), CV_8UC4);
            for (int y = 1; y < 19; ++y) {
                EXPECT_EQ(folded.pixels.at<cv::Vec4b>(y, 10), cv::Vec4b(90, 60, 30, 255));
                EXPECT_EQ(folded.pixels.at<cv::Vec4b>(y, 21)[3], 0);
                const auto at_fold = folded.pixels.at<cv::Vec4b>(y, 20);
                EXPECT_NEAR(at_fold[3], 0.4 * 255, 1.01);
                EXPECT_NEAR(at_fold[0], 90, 1.01);
            }
        }
    }
}

TEST(BackFaces, TrianglesWithoutAreaAreNeverDrawn) {
    Random random(11);
    const Image image = random_image(10, 10, CV_8UC4, random, Alpha::opaque);
    const TriangleMesh rest = grid_mesh(0, 0, 10, 10, 2, 2, random);
    WarpOptions options;
    options.back_faces = BackFaces::show;
    options.depth = rest.V.col(0);
    Eigen::MatrixX2d flat = rest.V;
    flat.col(1) = rest.V.col(0);
    EXPECT_EQ(cv::countNonZero(warp(image, rest, flat, options).pixels.reshape(1)), 0);
    flat.setConstant(5.5);
    EXPECT_EQ(cv::countNonZero(warp(image, rest, flat, options).pixels.reshape(1)), 0);
    EXPECT_EQ(cv::countNonZero(warp(image, {flat, rest.F}, rest.V, options).pixels.reshape(1)), 0);
    EXPECT_THROW(back_faces_from_name("both"), InvalidInput);
    for (const BackFaces each : {BackFaces::hide, BackFaces::show}) {
        EXPECT_EQ(back_faces_from_name(back_faces_name(each)), each);
    }
}

TEST(Overlap, GivesTheSameBytesForAnyNumberOfThreadsAndAnyInstructions) {
    Random random(12);
    const int before = thread_count();
    for (const int type : {CV_8UC4, CV_8UC3, CV_16UC4, CV_32FC4}) {
        const Image image = random_image(150, 131, type, random, Alpha::patches);
        const TriangleMesh rest = grid_mesh(-2, -2, 152, 133, 9, 7, random);
        const Eigen::MatrixX2d moved = jittered(rest.V, 30, random);
        WarpOptions options;
        options.canvas = {-9, -9, 170, 150};
        options.back_faces = BackFaces::show;
        options.depth = Eigen::VectorXd::LinSpaced(rest.V.rows(), 1, -1).array().sin();
        Progress progress;
        set_thread_count(1);
        const Image expected = detail::warp_with(detail::Simd::scalar, image, rest, moved, options, progress);
        for (const int threads : {1, 2, 7}) {
            set_thread_count(threads);
            for (const detail::Simd simd : {detail::Simd::scalar, detail::Simd::sse41, detail::Simd::avx2}) {
                if (simd > detail::best_simd()) continue;
                const Image result = detail::warp_with(simd, image, rest, moved, options, progress);
                EXPECT_TRUE(same_bytes(result.pixels, expected.pixels)) << threads << " threads";
            }
        }
    }
    set_thread_count(before);
}

}  // namespace
}  // namespace puppetwarp::testing
