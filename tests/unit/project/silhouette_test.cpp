// What the edge of a warped subject looks like over other backgrounds: its own colours, all of it, and nothing else.

#include <puppetwarp/project/pipeline.h>
#include <puppetwarp/warp/background.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace puppetwarp {
namespace {

constexpr int size = 120;
constexpr double radius = 36;

double coverage(int x, int y, double soft_px) {
    const double inside = radius - std::hypot(x + 0.5 - 60, y + 0.5 - 60);
    return soft_px == 0 ? (inside > 0 ? 1 : 0) : std::clamp(inside / soft_px + 0.5, 0.0, 1.0);
}

// The subject's colours, as shares of full scale: these lie no more than `variation` from the middle ones.
constexpr double middle[3] = {0.75, 0.5, 0.3};
constexpr double variation = 0.05;
double subject(int x, int y, int c) {
    return middle[c] + 0.03 * std::sin(0.2 * x) + 0.02 * std::cos(0.15 * y);
}

template <class Value>
cv::Mat drawn(int type, const Value& value) {
    cv::Mat values(size, size, CV_MAKETYPE(CV_64F, CV_MAT_CN(type))), pixels;
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            for (int c = 0; c < values.channels(); ++c)
                values.ptr<double>(y)[x * values.channels() + c] = value(x, y, c);
        }
    }
    const double full = CV_MAT_DEPTH(type) == CV_8U ? 255 : CV_MAT_DEPTH(type) == CV_16U ? 65535 : 1;
    values.convertTo(pixels, CV_MAT_DEPTH(type), full);
    return pixels;
}

//! With an alpha of its own, and a glaring green where nothing is to be seen.
Image with_alpha(int depth, double soft_px) {
    return {drawn(CV_MAKETYPE(depth, 4),
                  [&](int x, int y, int c) {
                      const double a = coverage(x, y, soft_px);
                      return c == 3 ? a : a > 0 ? subject(x, y, c) : c == 1 ? 1.0 : 0.0;
                  }),
            {}};
}

//! As a camera sees it before green, and the mask that cuts it out.
Image before_green(int depth, double soft_px) {
    return {drawn(CV_MAKETYPE(depth, 3),
                  [&](int x, int y, int c) {
                      const double a = coverage(x, y, soft_px);
                      return a * subject(x, y, c) + (1 - a) * (c == 1 ? 0.95 : 0.05);
                  }),
            {}};
}
Cutout mask(double soft_px) {
    return {false, drawn(CV_8UC1, [&](int x, int y, int) { return coverage(x, y, soft_px); })};
}

struct Motion {
    double turn_rad, scale, x, y;

    Eigen::MatrixX2d of(const Eigen::MatrixX2d& V) const {
        Eigen::Matrix2d A;
        A << std::cos(turn_rad), -std::sin(turn_rad), std::sin(turn_rad), std::cos(turn_rad);
        const Eigen::RowVector2d centre(60, 60);
        return (((V.rowwise() - centre) * (scale * A).transpose()).rowwise() + centre).rowwise() +
               Eigen::RowVector2d(x, y);
    }
};

constexpr Motion motions[] = {{0, 1, 0.5, 0.5}, {0, 1, 0.25, 3}, {0.44, 1, 0, 0}, {0.2, 1.4, 1, 0}, {0.1, 0.6, 0, 2}};

TriangleMesh mesh_of(const Cutout& cutout) {
    Puppet puppet;
    puppet.mesh.max_edge_px = 14;
    return mesh_subject(puppet, outline_subject(puppet, size, size, cutout));
}

double value_at(const Image& image, int x, int y, int c) {
    const int i = x * image.pixels.channels() + c;
    switch (image.pixels.depth()) {
        case CV_8U: return image.pixels.ptr<std::uint8_t>(y)[i] / 255.0;
        case CV_16U: return image.pixels.ptr<std::uint16_t>(y)[i] / 65535.0;
        default: return static_cast<double>(image.pixels.ptr<float>(y)[i]);
    }
}

// What a picture over some backgrounds says of the subject's colour: within those that it has, wherever it shows.
void expect_own_colours(const Image& warped, const char* what) {
    ASSERT_TRUE(warped.has_alpha());
    int edges = 0;
    for (const char* name : {"#000000", "#ffffff", "#ff00ff"}) {
        const Background background = background_from_name(name);
        const Image over = lay_over(background, warped, warped, {0, 0, size, size});
        for (int y = 0; y < size; ++y) {
            for (int x = 0; x < size; ++x) {
                const double a = value_at(warped, x, y, 3);
                if (a < 0.1) continue;
                edges += a < 0.99 ? 1 : 0;
                const double rounding = warped.pixels.depth() == CV_8U ? 1.6 / 255 / a : 0.002 / a;
                for (int c = 0; c < 3; ++c) {
                    const double own =
                        (value_at(over, x, y, c) - (1 - a) * background.rgba[static_cast<std::size_t>(c)]) / a;
                    ASSERT_NEAR(own, middle[c], variation + 0.02 + rounding)
                        << what << " over " << name << " at " << x << ", " << y << " alpha " << a;
                }
            }
        }
    }
    EXPECT_GT(edges, 50);
}

class Silhouette : public testing::TestWithParam<int> {};

TEST_P(Silhouette, HasTheSubjectsOwnColours) {
    for (const double soft_px : {0.0, 1.0, 3.0, 8.0}) {
        const Image image = with_alpha(GetParam(), soft_px);
        const Cutout cutout = cut_out(image);
        const TriangleMesh mesh = mesh_of(cutout);
        for (const Interpolation interpolation :
             {Interpolation::bilinear, Interpolation::bicubic, Interpolation::lanczos3}) {
            for (const Motion& motion : motions) {
                WarpOptions options;
                options.interpolation = interpolation;
                const Image warped = warp(cut_subject(image, cutout, {}), mesh, motion.of(mesh.V), options);
                expect_own_colours(warped, "alpha");
                if (HasFatalFailure()) FAIL() << soft_px << " px soft";
            }
        }
    }
}

TEST_P(Silhouette, LeavesTheOldBackgroundBehind) {
    for (const double soft_px : {1.0, 2.0, 4.0}) {
        const Image image = before_green(GetParam(), soft_px);
        const Cutout cutout = mask(soft_px);
        const TriangleMesh mesh = mesh_of(cutout);
        for (const Motion& motion : motions) {
            const Image warped = warp(cut_subject(image, cutout, {}), mesh, motion.of(mesh.V));
            expect_own_colours(warped, "mask");
            if (HasFatalFailure()) FAIL() << soft_px << " px soft";
        }
    }
}

TEST_P(Silhouette, LosesNothingWhenMovedByHalfAPixel) {
    for (const double soft_px : {0.0, 1.0, 3.0, 8.0}) {
        const Image image = with_alpha(GetParam(), soft_px);
        const TriangleMesh mesh = mesh_of(cut_out(image));
        const auto mass = [](const Image& picture) {
            cv::Mat alpha;
            cv::extractChannel(picture.pixels, alpha, 3);
            return cv::sum(alpha)[0];
        };
        for (const Interpolation interpolation :
             {Interpolation::bilinear, Interpolation::bicubic, Interpolation::lanczos3}) {
            for (const auto& [x, y] : {std::pair{0.5, 0.0}, {0.0, 0.5}, {0.5, 0.5}, {-3.5, 7.5}}) {
                WarpOptions options;
                options.interpolation = interpolation;
                const Image moved = warp(image, mesh, mesh.V.rowwise() + Eigen::RowVector2d(x, y), options);
                EXPECT_NEAR(mass(moved) / mass(image), 1, 1e-3) << soft_px << " px soft, moved " << x << ", " << y;
            }
        }
    }
}

// Where anything shows: colour under alpha 0 is nobody's.
TEST_P(Silhouette, AtRestIsThePicture) {
    for (const double soft_px : {0.0, 1.0, 8.0}) {
        const Image image = with_alpha(GetParam(), soft_px);
        const TriangleMesh mesh = mesh_of(cut_out(image));
        const Image rest = warp(cut_subject(image, cut_out(image), {}), mesh, mesh.V);
        const Image opaque = before_green(GetParam(), soft_px);
        const Image cut =
            warp(cut_subject(opaque, mask(soft_px), {}), mesh_of(mask(soft_px)), mesh_of(mask(soft_px)).V);
        const Background keep{Background::Kind::keep, {}};
        const Image kept = lay_over(
            keep, warp(cut_subject(opaque, mask(soft_px), keep), mesh_of(mask(soft_px)), mesh_of(mask(soft_px)).V),
            opaque, {0, 0, size, size});
        ASSERT_EQ(rest.pixels.type(), image.pixels.type());
        ASSERT_EQ(kept.pixels.type(), opaque.pixels.type());
        for (int y = 0; y < size; ++y) {
            for (int x = 0; x < size; ++x) {
                const std::size_t colours = opaque.pixels.elemSize();
                if (value_at(image, x, y, 3) > 0) {
                    ASSERT_EQ(std::memcmp(rest.pixels.ptr(y, x), image.pixels.ptr(y, x), image.pixels.elemSize()), 0);
                }
                if (coverage(x, y, soft_px) >= 1) {
                    ASSERT_EQ(std::memcmp(cut.pixels.ptr(y, x), opaque.pixels.ptr(y, x), colours), 0);
                }
            }
        }
        EXPECT_EQ(cv::norm(kept.pixels, opaque.pixels, cv::NORM_INF), 0) << soft_px;
    }
}

INSTANTIATE_TEST_SUITE_P(Depths, Silhouette, testing::Values(CV_8U, CV_16U, CV_32F));

}  // namespace
}  // namespace puppetwarp
