// Results at other scales, pictures at other resolutions than the rig's, and what a run leaves beside its picture.
#include "support/message_of.h"
#include "support/run_command.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>
#include <puppetwarp/mesh/mesh_file.h>
#include <puppetwarp/project/overlay.h>
#include <puppetwarp/project/pipeline.h>
#include <puppetwarp/project/rendered_files.h>
#include <puppetwarp/warp/displacement_file.h>

#include <opencv2/core.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

namespace puppetwarp {
namespace {

using testing::HasSubstr;

// A smooth picture: colours along both axes, and an ellipse of alpha when asked for.
Image smooth_picture(int width, int height, bool alpha) {
    Image image{cv::Mat(height, width, alpha ? CV_8UC4 : CV_8UC3), {}};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double u = (x + 0.5) / width, v = (y + 0.5) / height;
            auto* p = image.pixels.ptr(y, x);
            p[0] = static_cast<std::uint8_t>(std::lround(127 + 100 * std::sin(7 * u + 3 * v)));
            p[1] = static_cast<std::uint8_t>(std::lround(255 * u));
            p[2] = static_cast<std::uint8_t>(std::lround(255 * v));
            if (!alpha) continue;
            const double inside = 0.4 - std::hypot(u - 0.5, v - 0.5);
            p[3] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(inside * width + 0.5, 0.0, 1.0)));
        }
    }
    return image;
}

bool same_visible(const cv::Mat& a, const cv::Mat& b) {
    if (a.size() != b.size() || a.type() != CV_8UC4 || b.type() != CV_8UC4) return false;
    for (int y = 0; y < a.rows; ++y) {
        for (int x = 0; x < a.cols; ++x) {
            const auto p = a.at<cv::Vec4b>(y, x), q = b.at<cv::Vec4b>(y, x);
            if (p != q && (p[3] != 0 || q[3] != 0)) return false;
        }
    }
    return true;
}

class Resolution : public testing::Test {
protected:
    // A puppet on a picture of 120 x 80 whose right pin is lifted; `large.png` is the same view, three times as large.
    explicit Resolution(bool alpha = true)
        : small(smooth_picture(120, 80, alpha)), large(smooth_picture(360, 240, alpha)) {
        write_image(small, folder / "small.png");
        write_image(large, folder / "large.png");
        puppet.folder = folder.path();
        puppet.image = "small.png";
        puppet.rig.handles = {{"a", PointHandle{{45, 40}, {}}}, {"b", PointHandle{{75, 40}, {}}}};
        pose.name = "lifted";
        pose.handles["b"].to = Point(80, 28);
    }

    RenderOptions drawing(const std::string& picture, double scale = 1) const {
        RenderOptions options;
        if (!picture.empty()) options.image = folder / picture;
        options.scale = scale;
        options.keep_source = true;
        return options;
    }

    tests::TemporaryFolder folder;
    Image small, large;
    Puppet puppet;
    Pose pose;
    Progress progress;
};

class WholeResolution : public Resolution {
protected:
    WholeResolution() : Resolution(false) {}
};

TEST_F(Resolution, AScaledResultIsTheWarpOfScaledPositions) {
    const Rendered plain = render(puppet, pose, drawing(""), progress);
    for (const double scale : {2.0, 0.5, 1.37}) {
        const Rendered scaled = render(puppet, pose, drawing("", scale), progress);
        EXPECT_EQ(scaled.moved, plain.moved);  // image space does not change
        EXPECT_EQ(scaled.report.scale, scale);
        const Canvas canvas{0, 0, static_cast<int>(std::lround(120 * scale)),
                            static_cast<int>(std::lround(80 * scale))};
        EXPECT_EQ(scaled.image.width(), canvas.width);
        EXPECT_EQ(scaled.image.height(), canvas.height);
        const Image direct = warp(small, plain.mesh, plain.moved * scale, {Interpolation::bicubic, canvas});
        EXPECT_EQ(cv::norm(scaled.image.pixels, direct.pixels, cv::NORM_INF), 0) << scale;
    }
    EXPECT_TRUE(
        same_visible(render(puppet, find_pose(puppet, "rest"), drawing("", 1), progress).image.pixels, small.pixels));
}

TEST_F(Resolution, CanvasesAreScaledToo) {
    RenderOptions options = drawing("", 2);
    options.canvas = {CanvasChoice::Kind::given, {-10, 5, 50, 40}};
    const Rendered given = render(puppet, pose, options, progress);
    EXPECT_EQ(given.report.canvas.x, -20);
    EXPECT_EQ(given.report.canvas.y, 10);
    EXPECT_EQ(given.image.width(), 100);
    EXPECT_EQ(given.image.height(), 80);
    const Rendered all = render(puppet, pose, drawing("", 2), progress);
    const cv::Rect there(0, 10, 80, 80), here(20, 0, 80, 80);
    EXPECT_EQ(cv::norm(all.image.pixels(there), given.image.pixels(here), cv::NORM_INF), 0);

    pose.handles["a"].to = Point(-20, 40);
    options.canvas = {CanvasChoice::Kind::grow, {}};
    const Rendered grown = render(puppet, pose, options, progress);
    EXPECT_EQ(grown.report.canvas.x, std::floor(2 * grown.moved.col(0).minCoeff() + 5e-5));
    EXPECT_EQ(grown.report.canvas.y, 0);
    EXPECT_EQ(grown.report.canvas.width + grown.report.canvas.x, 240);
}

TEST_F(Resolution, TheBackgroundThatIsKeptIsScaled) {
    puppet.background = "keep";
    const Rendered scaled = render(puppet, pose, drawing("", 2), progress);
    ASSERT_EQ(scaled.image.width(), 240);
    // In the corner nothing was moved away: the original, magnified, transparent where it was.
    const auto corner = scaled.image.pixels.at<cv::Vec4b>(4, 4);
    EXPECT_EQ(corner[3], 0);
    // Where the subject left, its old place shows through: twice (52, 40) is far left of what moved.
    for (const auto& [x, y] : {std::pair{100, 84}, {60, 70}}) {
        EXPECT_EQ(scaled.image.pixels.at<cv::Vec4b>(y, x)[3], 255) << x << ", " << y;
    }
}

TEST_F(WholeResolution, WholePicturesStayWithoutAlphaAndKeepTheirGround) {
    RenderOptions options = drawing("", 1.5);
    puppet.background = "keep";
    const Rendered kept = render(puppet, pose, options, progress);
    ASSERT_EQ(kept.image.pixels.type(), CV_8UC3);
    EXPECT_EQ(kept.image.pixels.size(), cv::Size(180, 120));
    // The lower left corner is uncovered or still: smooth colours, as the magnified original has them.
    const auto pixel = kept.image.pixels.at<cv::Vec3b>(118, 2);
    EXPECT_NEAR(pixel[1], 255 * 2.5 / 180, 6);
    EXPECT_NEAR(pixel[2], 255 * 118.5 / 120, 6);

    const Rendered rest = render(puppet, find_pose(puppet, "rest"), options, progress);
    EXPECT_EQ(rest.image.pixels.type(), CV_8UC3);
}

TEST_F(Resolution, ARigMadeOnAProxyRendersAtFullSize) {
    const Rendered proxy = render(puppet, pose, drawing(""), progress);
    const Rendered full = render(puppet, pose, drawing("large.png"), progress);
    EXPECT_EQ(full.image.pixels.size(), cv::Size(360, 240));
    EXPECT_EQ(full.report.scale, 3);
    EXPECT_LT(full.report.max_handle_error_px, 0.01);  // in image space, which is the proxy's
    // The same picture as from the proxy, with the details of the large one.
    const Rendered magnified = render(puppet, pose, drawing("", 3), progress);
    int compared = 0;
    for (int y = 0; y < 240; ++y) {
        for (int x = 0; x < 360; ++x) {
            const auto a = full.image.pixels.at<cv::Vec4b>(y, x), b = magnified.image.pixels.at<cv::Vec4b>(y, x);
            if (a[3] < 255 || b[3] < 255) continue;
            ++compared;
            for (int c = 0; c < 3; ++c) ASSERT_NEAR(a[c], b[c], 8) << x << ", " << y;
        }
    }
    EXPECT_GT(compared, 30000);

    // And at rest, every pixel of it.
    const Rendered rest = render(puppet, find_pose(puppet, "rest"), drawing("large.png"), progress);
    EXPECT_TRUE(same_visible(rest.image.pixels, large.pixels));
    // The reverse: a rig made on the full picture, drawn with the proxy.
    puppet.image = "large.png";
    puppet.rig.handles = {{"a", PointHandle{{135, 120}, {}}}, {"b", PointHandle{{225, 120}, {}}}};
    const Rendered reverse = render(puppet, find_pose(puppet, "rest"), drawing("small.png"), progress);
    EXPECT_TRUE(same_visible(reverse.image.pixels, small.pixels));
    EXPECT_NEAR(reverse.report.scale, 1.0 / 3, 1e-15);
}

TEST_F(Resolution, CoordinatesStayThoseOfTheRig) {
    RenderOptions options = drawing("large.png", 0.5);
    options.canvas = {CanvasChoice::Kind::given, {20, 10, 60, 50}};
    const Rendered rendered = render(puppet, pose, options, progress);
    EXPECT_EQ(rendered.report.canvas.x, 30);
    EXPECT_EQ(rendered.report.canvas.y, 15);
    EXPECT_EQ(rendered.image.width(), 90);
    EXPECT_EQ(rendered.image.height(), 75);
    EXPECT_EQ(rendered.report.scale, 1.5);
}

TEST_F(Resolution, PolygonsAndMasksAreThoseOfTheRig) {
    puppet.cutout.from = "polygon";
    puppet.cutout.points = {{30, 20}, {90, 20}, {90, 60}, {30, 60}};
    const Rendered polygon = render(puppet, find_pose(puppet, "rest"), drawing("large.png"), progress);
    EXPECT_EQ(polygon.image.pixels.at<cv::Vec4b>(120, 88)[3], 0);
    EXPECT_EQ(polygon.image.pixels.at<cv::Vec4b>(120, 92), large.pixels.at<cv::Vec4b>(120, 92));

    puppet.cutout.from = "mask";
    puppet.cutout.path = "mask.png";
    for (const int factor : {1, 3}) {
        Image mask{cv::Mat::zeros(80 * factor, 120 * factor, CV_8UC1), {}};
        mask.pixels(cv::Rect(30 * factor, 20 * factor, 60 * factor, 40 * factor)).setTo(cv::Scalar(255));
        write_image(mask, folder / "mask.png");
        const Rendered masked = render(puppet, find_pose(puppet, "rest"), drawing("large.png"), progress);
        EXPECT_EQ(masked.image.pixels.at<cv::Vec4b>(120, 86)[3], 0) << factor;
        EXPECT_EQ(masked.image.pixels.at<cv::Vec4b>(120, 94), large.pixels.at<cv::Vec4b>(120, 94)) << factor;
    }
    write_image({cv::Mat::zeros(10, 10, CV_8UC1), {}}, folder / "mask.png");
    EXPECT_THAT(message_of([&] { render(puppet, pose, drawing("large.png"), progress); }), HasSubstr("mask"));
}

// A hair that the proxy's pixels are too large for is covered all the same.
TEST_F(Resolution, ThinPartsOfTheLargePictureAreCovered) {
    large.pixels(cv::Rect(5, 100, 60, 1)).setTo(cv::Scalar(10, 20, 30, 3));
    write_image(large, folder / "large.png");
    const Rendered rest = render(puppet, find_pose(puppet, "rest"), drawing("large.png"), progress);
    EXPECT_TRUE(same_visible(rest.image.pixels, large.pixels));
}

TEST_F(Resolution, AnotherShapeIsRefused) {
    write_image(smooth_picture(360, 300, true), folder / "other.png");
    EXPECT_THAT(message_of([&] { render(puppet, pose, drawing("other.png"), progress); }),
                testing::AllOf(HasSubstr("360 x 300"), HasSubstr("120 x 80")));
    // Sides are whole numbers: a pixel more or less is the same shape.
    write_image(smooth_picture(361, 240, true), folder / "other.png");
    EXPECT_EQ(render(puppet, pose, drawing("other.png"), progress).image.width(), 361);
    puppet.image = "gone.png";
    EXPECT_THAT(message_of([&] { render(puppet, pose, drawing("large.png"), progress); }), HasSubstr("gone.png"));
    puppet.image.clear();  // coordinates are then those of the picture that is given
    EXPECT_EQ(render(puppet, pose, drawing("small.png"), progress).report.scale, 1);
}

TEST_F(Resolution, WhatIsTooLargeIsRefusedBeforeAnythingIsDecoded) {
    // A JPEG whose header is sound and whose pixels end early: whoever decodes it complains of that.
    write_image(smooth_picture(400, 300, false), folder / "whole.jpg");
    const std::string bytes = tests::bytes_of(folder / "whole.jpg");
    tests::put_bytes(folder / "cut.jpg", bytes.substr(0, bytes.size() / 2));
    puppet.image = "cut.jpg";
    EXPECT_THAT(message_of([&] { render(puppet, pose, {}, progress); }), HasSubstr("cut.jpg"));
    RenderOptions options;
    options.canvas = {CanvasChoice::Kind::given, {0, 0, 100'000, 30'000}};
    EXPECT_THAT(message_of([&] { render(puppet, pose, options, progress); }), HasSubstr("canvas"));
    options.canvas = {CanvasChoice::Kind::given, {0, 0, 10'000, 10'000}};
    options.scale = 2;
    EXPECT_THAT(message_of([&] { render(puppet, pose, options, progress); }), HasSubstr("20000 x 20000"));
    options = {};
    options.scale = 50;
    EXPECT_THAT(message_of([&] { render(puppet, pose, options, progress); }), HasSubstr("20000 x 15000"));
    options.canvas.kind = CanvasChoice::Kind::grow;
    EXPECT_THAT(message_of([&] { render(puppet, pose, options, progress); }), HasSubstr("20000 x 15000"));
    options = {};
    options.image = folder / "cut.jpg";
    options.read.max_pixels = 100;
    puppet.image = "small.png";
    EXPECT_THAT(message_of([&] { render(puppet, pose, options, progress); }), HasSubstr("400 x 300"));
    for (const double scale : {0.0, -1.0, 1e-9, std::nan(""), 1e300}) {
        options = {};
        options.scale = scale;
        EXPECT_NE(message_of([&] { render(puppet, pose, options, progress); }), "") << scale;
    }
}

TEST_F(Resolution, TargetsThatGrowTheCanvasBeyondTheLimitAreRefusedBeforeDrawing) {
    pose.handles["a"].to = Point(-20'000, -20'000);
    RenderOptions options = drawing("");
    options.canvas.kind = CanvasChoice::Kind::grow;
    EXPECT_THAT(message_of([&] { render(puppet, pose, options, progress); }), HasSubstr("--max-pixels"));
    options.scale = 0.1;  // the same, a hundredth as large
    EXPECT_LT(render(puppet, pose, options, progress).report.canvas.x, -1900);
    pose.handles["a"].to = Point(-1e9, 0);
    EXPECT_NE(message_of([&] { render(puppet, pose, options, progress); }), "");
}

TEST_F(Resolution, OverlaysAreDrawnWhereTheResultIs) {
    RenderOptions options = drawing("large.png", 0.5);
    options.canvas = {CanvasChoice::Kind::given, {-7, -5, 130, 90}};
    Rendered rendered = render(puppet, pose, options, progress);
    draw_handles(rendered, pose);
    const auto at = [&](double x, double y) {
        return rendered.image.pixels.at<cv::Vec4b>(static_cast<int>(1.5 * y) - rendered.report.canvas.y,
                                                   static_cast<int>(1.5 * x) - rendered.report.canvas.x);
    };
    EXPECT_EQ(at(45, 40), cv::Vec4b(255, 191, 0, 255));
    EXPECT_EQ(at(80, 28), cv::Vec4b(255, 191, 0, 255));
    Rendered meshed = render(puppet, pose, options, progress);
    draw_mesh(meshed);
    const Point vertex = 1.5 * meshed.moved.row(0).transpose() - Point(meshed.report.canvas.x, meshed.report.canvas.y);
    const auto pixel = meshed.image.pixels.at<cv::Vec4b>(static_cast<int>(vertex.y()), static_cast<int>(vertex.x()));
    EXPECT_GT(pixel[2], 150);
    EXPECT_GT(pixel[3], 150);
}

TEST_F(Resolution, TheMovedMeshKnowsItsPicture) {
    const Rendered rendered = render(puppet, pose, drawing("large.png", 0.5), progress);
    write_moved_mesh(rendered, folder / "moved.obj");
    EXPECT_EQ(read_mesh(folder / "moved.obj").V, rendered.moved);
    EXPECT_EQ(read_mesh(folder / "moved.obj").F, rendered.mesh.F);
    std::ifstream obj(folder / "moved.obj");
    std::string line;
    Eigen::Index vertex = 0;
    while (std::getline(obj, line)) {
        if (!line.starts_with("vt ")) continue;
        double s = 0, t = 0;
        std::istringstream(line.substr(3)) >> s >> t;
        ASSERT_NEAR(s * 120, rendered.mesh.V(vertex, 0), 1e-9);
        ASSERT_NEAR((1 - t) * 80, rendered.mesh.V(vertex, 1), 1e-9);
        ++vertex;
    }
    EXPECT_EQ(vertex, rendered.mesh.V.rows());
    write_moved_mesh(rendered, folder / "moved.off");
    EXPECT_EQ(read_mesh(folder / "moved.off").V, rendered.moved);
    write_moved_mesh(rendered, folder / "moved.svg");
    EXPECT_THAT(tests::bytes_of(folder / "moved.svg"),
                HasSubstr("width=\"180\" height=\"120\" viewBox=\"0 0 120 80\""));
    EXPECT_THAT(message_of([&] { write_moved_mesh(rendered, folder / "moved.png"); }), HasSubstr(".svg"));
}

TEST_F(Resolution, MapsLeadBackToThePicture) {
    for (const double scale : {1.0, 1.5}) {
        const RenderOptions options = drawing("large.png", scale);
        const Rendered rendered = render(puppet, pose, options, progress);
        for (const char* name : {"map.exr", "map.tif"}) {
            write_displacement(displacement_of(rendered, options), folder / name, {}, progress);
            RenderOptions back;
            back.canvas.kind = CanvasChoice::Kind::of_map;
            const Rendered again = render_through(folder / "large.png", folder / name, "transparent", back, progress);
            EXPECT_TRUE(again.report.method.empty());
            ASSERT_EQ(again.image.pixels.size(), rendered.image.pixels.size());
            cv::Mat difference, visible;
            cv::absdiff(again.image.pixels, rendered.image.pixels, difference);
            // Only along edges of triangles, whose two sides a map of single places cannot both hold.
            EXPECT_LT(cv::countNonZero(difference.reshape(1) > 1), again.image.width()) << name << scale;
        }
        // An EXR knows its source's size: the proxy comes out as large as it is.
        RenderOptions back;
        back.canvas.kind = CanvasChoice::Kind::of_map;
        const Rendered proxy = render_through(folder / "small.png", folder / "map.exr", "transparent", back, progress);
        EXPECT_EQ(proxy.image.width(), std::lround(120 * scale));
        back.scale = 3;
        EXPECT_EQ(render_through(folder / "small.png", folder / "map.exr", "transparent", back, progress).image.width(),
                  std::lround(360 * scale));
    }
}

TEST_F(WholeResolution, ACutoutThatIsNotInThePictureIsInItsMap) {
    puppet.cutout.from = "polygon";
    puppet.cutout.points = {{30, 20}, {90, 20}, {90, 60}, {30.5, 60.5}};
    const RenderOptions options = drawing("");
    const Rendered rendered = render(puppet, pose, options, progress);
    write_displacement(displacement_of(rendered, options), folder / "map.exr", {}, progress);
    RenderOptions back;
    back.canvas.kind = CanvasChoice::Kind::of_map;
    const Rendered again = render_through(folder / "small.png", folder / "map.exr", "transparent", back, progress);
    ASSERT_EQ(again.image.pixels.type(), CV_8UC4);
    cv::Mat alpha, wanted;
    cv::extractChannel(again.image.pixels, alpha, 3);
    cv::extractChannel(rendered.image.pixels, wanted, 3);
    EXPECT_LE(cv::norm(alpha, wanted, cv::NORM_INF), 1);
    EXPECT_GT(cv::countNonZero(wanted == 255), 2000);
    EXPECT_GT(cv::countNonZero(wanted == 0), 4000);
}

TEST_F(WholeResolution, CanvasesThroughAMap) {
    const RenderOptions options = drawing("");
    RenderOptions grown = options;
    grown.canvas.kind = CanvasChoice::Kind::grow;
    pose.handles["a"].to = Point(-5, 40);
    const Rendered rendered = render(puppet, pose, grown, progress);
    ASSERT_LT(rendered.report.canvas.x, 0);
    write_displacement(displacement_of(rendered, grown), folder / "map.exr", {}, progress);
    const auto canvas = [&](CanvasChoice choice) {
        RenderOptions back;
        back.canvas = choice;
        return render_through(folder / "small.png", folder / "map.exr", "#ffffff", back, progress).report.canvas;
    };
    const Canvas all = canvas({CanvasChoice::Kind::of_map, {}});
    EXPECT_EQ(all.x, rendered.report.canvas.x);
    EXPECT_EQ(all.width, rendered.report.canvas.width);
    EXPECT_EQ(canvas({CanvasChoice::Kind::grow, {}}).x, all.x);
    EXPECT_EQ(canvas({CanvasChoice::Kind::keep, {}}).x, 0);
    EXPECT_EQ(canvas({CanvasChoice::Kind::keep, {}}).width, 120);
    EXPECT_EQ(canvas({CanvasChoice::Kind::given, {3, 4, 5, 6}}).width, 5);
    RenderOptions back;
    back.canvas.kind = CanvasChoice::Kind::of_map;
    back.read.max_pixels = 120 * 80;  // the picture itself, and no pixel more
    EXPECT_THAT(message_of([&] { render_through(folder / "small.png", folder / "map.exr", "keep", back, progress); }),
                HasSubstr("--max-pixels"));
}

TEST_F(Resolution, MapsOfAnotherPictureAndCoarseOnesAreSpokenOf) {
    const RenderOptions options = drawing("");
    write_displacement(displacement_of(render(puppet, pose, options, progress), options), folder / "map.exr", {},
                       progress);
    write_image(smooth_picture(120, 100, true), folder / "other.png");
    EXPECT_THAT(message_of([&] { render_through(folder / "other.png", folder / "map.exr", "keep", {}, progress); }),
                testing::AllOf(HasSubstr("map.exr"), HasSubstr("120 x 80"), HasSubstr("120 x 100")));
    Image coarse{cv::Mat(8, 12, CV_16UC3, cv::Scalar::all(30000)), {}};
    write_image(coarse, folder / "coarse.png");
    const auto warnings = [&](const char* picture) {
        return render_through(folder / picture, folder / "coarse.png", "keep", {}, progress).report.warnings;
    };
    EXPECT_TRUE(warnings("small.png").empty());
    write_image({cv::Mat(10, 9000, CV_8UC3, cv::Scalar::all(30)), {}}, folder / "wide.png");
    EXPECT_THAT(warnings("wide.png"), testing::ElementsAre(HasSubstr("rounded to 0.069 px")));
}

}  // namespace
}  // namespace puppetwarp
