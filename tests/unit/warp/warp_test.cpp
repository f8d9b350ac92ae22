#include "reference.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/warp/warp_job.h>

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace puppetwarp::testing {
namespace {

WarpOptions with(Interpolation interpolation, Canvas canvas = {}) {
    WarpOptions options;
    options.interpolation = interpolation;
    options.canvas = canvas;
    return options;
}

// What one pixel of a warped picture may differ from the reference by.
double tolerance(const Image& image, double layers) {
    const double levels = image.pixels.depth() == CV_8U ? 1.0 : image.pixels.depth() == CV_16U ? 16.0 : 2e-5;
    return levels * layers + 1e-9;
}

void expect_like_reference(const Image& image, const TriangleMesh& rest, const Eigen::MatrixX2d& moved,
                           const WarpOptions& options, double layers) {
    const Image result = warp(image, rest, moved, options);
    const Reference reference(image, rest, moved, options);
    const double most = tolerance(image, layers);
    const int colours = image.pixels.channels() <= 2 ? 1 : 3;
    int compared = 0;
    for (int y = 0; y < result.height(); ++y) {
        for (int x = 0; x < result.width(); ++x) {
            const Premultiplied expected = reference.at(x, y);
            if (expected[4] != 0) continue;
            ++compared;
            const double alpha =
                result.has_alpha() ? value_at(result, x, y, result.alpha_channel()) : result.full_value();
            ASSERT_NEAR(alpha, expected[3] * result.full_value(), most) << "alpha at " << x << ", " << y;
            if (expected[3] < 0.1) continue;  // hardly visible: colour is badly determined
            for (int c = 0; c < colours; ++c) {
                ASSERT_NEAR(value_at(result, x, y, c),
                            reference.stored(expected[static_cast<std::size_t>(c)] / expected[3]), most)
                    << "channel " << c << " at " << x << ", " << y;
            }
        }
    }
    ASSERT_GT(compared, result.width() * result.height() / 2);
}

class WarpFormats : public ::testing::TestWithParam<int> {};

TEST_P(WarpFormats, AgreeWithTheReference) {
    Random random(11);
    for (const Interpolation interpolation : all_interpolations) {
        for (const Alpha alpha : {Alpha::noise, Alpha::opaque, Alpha::patches}) {
            for (int round = 0; round < 2; ++round) {
                SCOPED_TRACE(interpolation_names()[static_cast<std::size_t>(interpolation)]);
                const Image image = random_image(31, 23, GetParam(), random, alpha);
                const TriangleMesh rest = grid_mesh(-2, -2, 33, 25, 4, 3, random);
                const Eigen::MatrixX2d moved = jittered(rest.V, 2.5, random);
                expect_like_reference(image, rest, moved, with(interpolation, {-4, -3, 40, 30}), 1);
                if (HasFatalFailure()) return;
            }
        }
    }
}

TEST_P(WarpFormats, AgreeWithTheReferenceWhenScaledTurnedAndFoldedOver) {
    Random random(12);
    for (const Interpolation interpolation : all_interpolations) {
        SCOPED_TRACE(interpolation_names()[static_cast<std::size_t>(interpolation)]);
        const Image image = random_image(24, 20, GetParam(), random, Alpha::patches);
        const TriangleMesh rest = grid_mesh(-2, -2, 26, 22, 3, 3, random);
        for (const double scale : {0.3, 0.6, 1.7, 4.0}) {
            const double angle = uniform(random, 0, 6);
            Eigen::Matrix2d turn;
            turn << std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle);
            const Eigen::RowVector2d centre(12, 10);
            Eigen::MatrixX2d moved = (((rest.V.rowwise() - centre) * (scale * turn)).rowwise() + centre).eval();
            expect_like_reference(image, rest, jittered(moved, 0.2 * scale, random), with(interpolation), 1);
            if (HasFatalFailure()) return;
        }
        // Two sheets: each stored layer is rounded once.
        TriangleMesh two = rest;
        two.V.resize(2 * rest.V.rows(), 2);
        two.V << rest.V, rest.V;
        two.F.resize(2 * rest.F.rows(), 3);
        two.F << rest.F, rest.F.array() + static_cast<int>(rest.V.rows());
        Eigen::MatrixX2d moved = jittered(two.V, 1.5, random);
        moved.bottomRows(rest.V.rows()).array() += 6.3;
        expect_like_reference(image, two, moved, with(interpolation), 2);
        if (HasFatalFailure()) return;
    }
}

TEST_P(WarpFormats, AgreeWithTheReferenceInLinearLight) {
    Random random(18);
    for (const Interpolation interpolation : all_interpolations) {
        SCOPED_TRACE(interpolation_names()[static_cast<std::size_t>(interpolation)]);
        for (const double scale : {0.4, 0.9, 2.5}) {
            const Image image = random_image(31, 23, GetParam(), random, Alpha::patches);
            const TriangleMesh rest = grid_mesh(-2, -2, 33, 25, 3, 3, random);
            WarpOptions options = with(interpolation, {-2, -2, 28, 24});
            options.linear = true;
            expect_like_reference(image, rest, jittered(rest.V * scale, 1.5 * scale, random), options, 1);
            if (HasFatalFailure()) return;
        }
    }
}

TEST_P(WarpFormats, RestPoseAndSolverNoiseGiveThePictureBack) {
    Random random(13);
    for (const Interpolation interpolation : all_interpolations) {
        const Image image = random_image(37, 29, GetParam(), random, Alpha::noise);
        const TriangleMesh rest = grid_mesh(-2, -2, 39, 31, 5, 4, random);
        EXPECT_TRUE(same_bytes(warp(image, rest, rest.V, with(interpolation)).pixels, image.pixels));
        EXPECT_TRUE(
            same_bytes(warp(image, rest, jittered(rest.V, 1e-6, random), with(interpolation)).pixels, image.pixels));
    }
}

TEST_P(WarpFormats, WholePixelTranslationsShiftThePicture) {
    Random random(14);
    const Image image = random_image(37, 29, GetParam(), random, Alpha::noise);
    const TriangleMesh rest = grid_mesh(-2, -2, 39, 31, 5, 4, random);
    for (const auto& [dx, dy] : {std::pair{5, -3}, {-36, 2}, {0, 28}}) {
        const Eigen::MatrixX2d moved = jittered(rest.V.rowwise() + Eigen::RowVector2d(dx, dy), 1e-6, random);
        const Image shifted = warp(image, rest, moved, with(Interpolation::bicubic, {-1, -4, 60, 50}));
        ASSERT_TRUE(shifted.has_alpha());
        for (int y = 0; y < image.height(); ++y) {
            for (int x = 0; x < image.width(); ++x) {
                const int to_x = x + dx + 1, to_y = y + dy + 4;
                if (to_x < 0 || to_y < 0 || to_x >= 60 || to_y >= 50) continue;
                for (int c = 0; c < image.pixels.channels(); ++c) {
                    ASSERT_EQ(value_at(shifted, to_x, to_y, c), value_at(image, x, y, c)) << x << ", " << y;
                }
            }
        }
    }
}

TEST_P(WarpFormats, ConstantPicturesStayConstant) {
    Random random(15);
    for (const Interpolation interpolation : all_interpolations) {
        for (int round = 0; round < 40; ++round) {
            Image image = random_image(19, 17, GetParam(), random, Alpha::opaque);
            for (int y = 0; y < 17; ++y) {
                for (int x = 0; x < 19; ++x) {
                    std::memcpy(image.pixels.ptr(y, x), image.pixels.ptr(0, 0), image.pixels.elemSize());
                }
            }
            const TriangleMesh rest = grid_mesh(0, 0, 19, 17, 3, 3, random);
            const Image result = warp(image, rest, jittered(rest.V, 4, random), with(interpolation));
            for (int y = 0; y < 17; ++y) {
                for (int x = 0; x < 19; ++x) {
                    // Fading beyond the border changes alpha, never colour.
                    if (result.has_alpha() && value_at(result, x, y, result.alpha_channel()) == 0) continue;
                    for (int c = 0; c < (image.pixels.channels() <= 2 ? 1 : 3); ++c) {
                        ASSERT_EQ(value_at(result, x, y, c), value_at(image, 0, 0, c));
                    }
                }
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(AllFormats, WarpFormats, ::testing::ValuesIn(all_types), format_name);

// v = a x + b y + c under an affine map is again such a plane, whose coefficients are known.
TEST(Warp, RampsStayOnTheirPlane) {
    Random random(21);
    for (const Interpolation interpolation :
         {Interpolation::bilinear, Interpolation::bicubic, Interpolation::lanczos3}) {
        for (int round = 0; round < 50; ++round) {
            const int a = static_cast<int>(random() % 201) - 100, b = static_cast<int>(random() % 201) - 100;
            Image image{cv::Mat(40, 40, CV_16UC3), {}};
            for (int y = 0; y < 40; ++y) {
                for (int x = 0; x < 40; ++x) {
                    const auto v = static_cast<std::uint16_t>(20000 + a * (2 * x + 1) + b * (2 * y + 1));
                    image.pixels.at<cv::Vec3w>(y, x) = {v, v, v};
                }
            }
            const TriangleMesh rest = grid_mesh(0, 0, 40, 40, 3, 3, random);
            Eigen::Matrix2d A;
            A << 1 + uniform(random, -0.2, 0.2), uniform(random, -0.3, 0.3), uniform(random, -0.3, 0.3), 1.1;
            const Eigen::RowVector2d t(uniform(random, -3, 3), uniform(random, -3, 3));
            const Image result = warp(image, rest, (rest.V * A).rowwise() + t, with(interpolation));
            for (int y = 0; y < 40; ++y) {
                for (int x = 0; x < 40; ++x) {
                    if (result.has_alpha() && value_at(result, x, y, 3) == 0) continue;
                    const Eigen::RowVector2d from = (Eigen::RowVector2d(x + 0.5, y + 0.5) - t) * A.inverse();
                    if (from.minCoeff() < 4 || from.maxCoeff() > 36) continue;
                    ASSERT_NEAR(value_at(result, x, y, 1), 20000 + 2 * a * from.x() + 2 * b * from.y(), 0.6);
                }
            }
        }
    }
}

// An alpha channel that is full everywhere must be full, or absent, wherever the mesh is: no crack, in 10,000 tries.
TEST(Warp, RandomDeformationsLeaveNoCrack) {
    Random random(22);
    const Image image{cv::Mat(12, 12, CV_8UC3, cv::Scalar(10, 200, 90)), {}};
    for (int round = 0; round < 10000; ++round) {
        const TriangleMesh rest = grid_mesh(-2, -2, 14, 14, 3, 3, random);
        Eigen::MatrixX2d moved = rest.V;
        for (const int inner : {5, 6, 9, 10}) {
            moved.row(inner) += Eigen::RowVector2d(uniform(random, -1.2, 1.2), uniform(random, -1.2, 1.2));
        }
        const Image result = warp(image, rest, moved, with(Interpolation::bilinear));
        ASSERT_TRUE(same_bytes(result.pixels, image.pixels)) << "round " << round;
    }
}

TEST(Warp, TransparentFringeDoesNotPunchAHole) {
    Random random(23);
    Image image{cv::Mat(40, 40, CV_8UC4, cv::Scalar(200, 100, 50, 255)), {}};
    for (int y = 0; y < 40; ++y) {
        for (int x = 20; x < 40; ++x) image.pixels.at<cv::Vec4b>(y, x) = {0, 0, 0, 0};
    }
    TriangleMesh rest = grid_mesh(0, 0, 40, 40, 1, 1, random);
    TriangleMesh two = rest;
    two.V.resize(8, 2);
    two.V << rest.V, rest.V;
    two.F.resize(4, 3);
    two.F << rest.F, rest.F.array() + 4;
    Eigen::MatrixX2d moved = two.V;
    moved.bottomRows(4).col(0).array() -= 10.5;  // the transparent half of the second sheet lies over the first
    const Image result = warp(image, two, moved, with(Interpolation::bilinear));
    for (int x = 0; x < 20; ++x) EXPECT_EQ(result.pixels.at<cv::Vec4b>(20, x), cv::Vec4b(200, 100, 50, 255)) << x;
}

// A subject cut off by the border: no smear outside, nothing translucent inside.
TEST(Warp, AlphaEndsAtTheBorderOfThePicture) {
    Random random(24);
    const Image image{cv::Mat(10, 10, CV_8UC4, cv::Scalar(9, 8, 7, 255)), {}};
    const TriangleMesh rest = grid_mesh(-2, -2, 12, 12, 2, 2, random);
    const Image result = warp(image, rest, rest.V * 4, with(Interpolation::bicubic, {-8, -8, 56, 56}));
    for (int x = 0; x < 56; ++x) {
        const double centre = x - 8 + 0.5;  // the picture spans [0, 40]
        const int alpha = result.pixels.at<cv::Vec4b>(28, x)[3];
        if (centre > 0 && centre < 40) {
            EXPECT_EQ(alpha, 255) << x;
        } else if (centre < -2 || centre > 42) {
            EXPECT_EQ(alpha, 0) << x;
        }
    }
}

TEST(Warp, AlphaAppearsOnlyWhenSomethingIsUncovered) {
    Random random(25);
    const Image image = random_image(20, 20, CV_8UC3, random);
    const TriangleMesh rest = grid_mesh(0, 0, 20, 20, 2, 2, random);
    Eigen::MatrixX2d moved = rest.V;
    moved.row(4).array() += 1.5;
    EXPECT_EQ(warp(image, rest, moved).pixels.type(), CV_8UC3);
    moved.row(0).array() += 1.5;
    const Image result = warp(image, rest, moved);
    ASSERT_EQ(result.pixels.type(), CV_8UC4);
    EXPECT_EQ(result.pixels.at<cv::Vec4b>(0, 0), cv::Vec4b(0, 0, 0, 0));
    EXPECT_EQ(result.pixels.at<cv::Vec4b>(19, 19)[3], 255);
    EXPECT_EQ(warp(image, {rest.V, Eigen::MatrixX3i(0, 3)}, rest.V).pixels.type(), CV_8UC4);
}

TEST(Warp, SinglePixelsAndSingleRowsWork) {
    Random random(26);
    for (const int type : all_types) {
        for (const auto& [width, height] : {std::pair{1, 1}, {3, 1}, {1, 5}, {2, 2}}) {
            for (const Interpolation interpolation : all_interpolations) {
                const Image image = random_image(width, height, type, random, Alpha::opaque);
                const TriangleMesh rest = grid_mesh(-2, -2, width + 2, height + 2, 1, 1, random);
                EXPECT_TRUE(same_bytes(warp(image, rest, rest.V, with(interpolation)).pixels, image.pixels));
                expect_like_reference(image, rest, jittered(rest.V * 3, 0.4, random),
                                      with(interpolation, {-4, -4, 14, 14}), 1);
                if (HasFatalFailure()) return;
            }
        }
    }
}

TEST(Warp, WildPositionsDoNoHarm) {
    Random random(27);
    const double wild[] = {1e300, -1e300, 1e9, -1e9, 1e-300, 0, 5.5, 2147483648.0};
    for (const int type : {CV_8UC3, CV_8UC4, CV_16UC4, CV_32FC2}) {
        const Image image = random_image(20, 20, type, random);
        for (int round = 0; round < 300; ++round) {
            const TriangleMesh rest = grid_mesh(-2, -2, 22, 22, 3, 3, random);
            Eigen::MatrixX2d moved = rest.V;
            for (int i = 0; i < 3; ++i) {
                moved(static_cast<Eigen::Index>(random() % 16), static_cast<Eigen::Index>(random() % 2)) =
                    wild[random() % 8];
            }
            const Interpolation interpolation = all_interpolations[round % 4];
            Progress progress;
            const WarpOptions options = with(interpolation, {-3, 4, 30, 25});
            const Image result = warp(image, rest, moved, options);
            ASSERT_TRUE(same_bytes(
                result.pixels, detail::warp_with(detail::Simd::scalar, image, rest, moved, options, progress).pixels));
        }
    }
}

TEST(Warp, RefusesWhatCannotBe) {
    Random random(28);
    const Image image = random_image(8, 8, CV_8UC3, random);
    const TriangleMesh rest = grid_mesh(0, 0, 8, 8, 1, 1, random);
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        Eigen::MatrixX2d moved = rest.V;
        moved(2, 1) = bad;
        EXPECT_THROW(warp(image, rest, moved), InvalidInput);
        EXPECT_THROW(warp(image, {moved, rest.F}, rest.V), InvalidInput);
        EXPECT_THROW(grown_canvas(8, 8, moved), InvalidInput);
    }
    EXPECT_THROW(warp(image, rest, rest.V.topRows(3)), InvalidInput);
    TriangleMesh broken = rest;
    broken.F(0, 0) = 4;
    EXPECT_THROW(warp(image, broken, rest.V), InvalidInput);
    EXPECT_THROW(warp(image, rest, rest.V, with(Interpolation::nearest, {0, 0, 65536, 65536})), InvalidInput);
    EXPECT_THROW(warp(image, rest, rest.V, with(Interpolation::nearest, {0, 0, -1, 5})), InvalidInput);
    EXPECT_THROW(warp(image, rest, rest.V, with(Interpolation::nearest, {2147483647, 0, 5, 5})), InvalidInput);
    EXPECT_THROW(interpolation_from_name("cubic"), InvalidInput);
    for (const std::string& name : interpolation_names()) EXPECT_NO_THROW(interpolation_from_name(name));
}

TEST(Warp, GrownCanvasHoldsPictureAndPositions) {
    Eigen::MatrixX2d moved(2, 2);
    moved << -3.2, 4, 9, 30.5;
    const Canvas canvas = grown_canvas(10, 20, moved);
    EXPECT_EQ(canvas.x, -4);
    EXPECT_EQ(canvas.y, 0);
    EXPECT_EQ(canvas.width, 14);
    EXPECT_EQ(canvas.height, 31);
    moved << -2.0000001, 0, 12, 22.0000001;  // noise of a solver
    EXPECT_EQ(grown_canvas(10, 20, moved).width, 14);
    EXPECT_EQ(grown_canvas(10, 20, moved).height, 22);
    moved << 0, 0, 1e300, 0;
    EXPECT_THROW(grown_canvas(10, 20, moved), InvalidInput);
    moved << 0, 0, 1e6, 1e6;
    EXPECT_THROW(grown_canvas(10, 20, moved), InvalidInput);
}

class CancelAfter : public Progress {
public:
    explicit CancelAfter(int steps) : steps_(steps) {}
    bool cancelled() const override { return steps_ <= 0; }
    double last = -1;

protected:
    void show(std::string_view stage, double fraction) override {
        EXPECT_EQ(stage, "warp");
        EXPECT_GE(fraction, last);
        last = fraction;
        --steps_;
    }

private:
    int steps_;
};

TEST(Warp, ReportsProgressAndCanBeCancelled) {
    Random random(29);
    const Image image{cv::Mat(2500, 2500, CV_8UC1, cv::Scalar(7)), {}};
    const TriangleMesh rest = grid_mesh(0, 0, 2500, 2500, 2, 2, random);
    CancelAfter never(1000);
    warp(image, rest, rest.V, {}, never);
    EXPECT_EQ(never.last, 1);
    CancelAfter soon(2);
    EXPECT_THROW(warp(image, rest, rest.V, {}, soon), Cancelled);
    EXPECT_LT(soon.last, 0.5);
}

}  // namespace
}  // namespace puppetwarp::testing
