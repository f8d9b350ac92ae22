#include <puppetwarp/project/method_sheet.h>

#include "support/run_command.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/image/write.h>
#include <puppetwarp/project/sheet_layout.h>

#include <opencv2/core.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace puppetwarp {
namespace {

using testing::HasSubstr;

// A small picture, all of it the subject, with two points; the second moves.
class MethodSheets : public testing::Test {
protected:
    MethodSheets() {
        Image image;
        image.pixels = cv::Mat(60, 90, CV_16UC3);
        for (int y = 0; y < 60; ++y) {
            for (int x = 0; x < 90; ++x) image.pixels.at<cv::Vec3w>(y, x) = cv::Vec3w::all((x * 53 + y * 31) % 65536);
        }
        write_image(image, folder / "subject.png");
        puppet.folder = folder.path();
        puppet.image = "subject.png";
        puppet.mesh.max_edge_px = 12;
        puppet.rig.handles = {{"left", PointHandle{{15, 30}, {}}}, {"right", PointHandle{{75, 30}, {}}}};
        pose.name = "up";
        pose.handles["right"].to = Point(80, 5);
        options.cell_px = 120;
    }

    MethodSheet sheet() {
        Progress progress;
        return compare_methods(puppet, pose, options, progress);
    }

    std::string refusal() {
        try {
            sheet();
        } catch (const InvalidInput& error) {
            return error.what();
        }
        return "no error";
    }

    tests::TemporaryFolder folder;
    Puppet puppet;
    Pose pose;
    MethodSheetOptions options;
};

TEST(LabelledMethods, AreAllThatThereAreAndEachEnergy) {
    std::vector<std::string> labels;
    for (const LabelledMethod& each : labelled_methods()) labels.push_back(each.label);
    for (const std::string& name : method_names()) EXPECT_EQ(std::count(labels.begin(), labels.end(), name), 1) << name;
    EXPECT_EQ(labels.size(), method_names().size() + 2);
    EXPECT_THAT(labels, testing::Contains("arap (spokes)"));
    EXPECT_THAT(labels, testing::Contains("arap (spokes-and-rims)"));
}

TEST(LabelledMethods, KeepWhatElseThePuppetAsksFor) {
    MethodOptions options;
    options.max_iterations = 7;
    options.arap_energy = ArapEnergy::spokes;
    for (const LabelledMethod& each : labelled_methods(options)) {
        EXPECT_EQ(each.options.max_iterations, 7);
        EXPECT_EQ(each.options.arap_energy == ArapEnergy::spokes, each.label == "arap (spokes)") << each.label;
    }
}

TEST_F(MethodSheets, HoldWhatEachMethodMakesOfTheSameMesh) {
    const MethodSheet made = sheet();
    const std::vector<LabelledMethod> all = labelled_methods();
    ASSERT_EQ(made.methods.size(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        const MethodResult& result = made.methods[i];
        EXPECT_EQ(result.label, all[i].label);
        ASSERT_EQ(result.error, "") << result.label;
        Progress progress;
        const Deformation alone = make_deformer(all[i].options, made.mesh, puppet.rig)->deform(pose, nullptr, progress);
        EXPECT_EQ(result.moved, alone.V) << result.label;
        EXPECT_EQ(result.report.energy, alone.energy) << result.label;
        ASSERT_EQ(result.report.timings_ms.size(), 2U);
        EXPECT_EQ(result.cut_off, runs_out_of(made.canvas, result.moved)) << result.label;
    }
    EXPECT_EQ(made.image.pixels.type(), CV_8UC3);
    EXPECT_GE(made.columns * made.rows, static_cast<int>(all.size()) + 1);
}

TEST_F(MethodSheets, AreTheSameBytesEachTimeForAnyNumberOfThreads) {
    for (const auto show : {MethodSheetOptions::Show::picture, MethodSheetOptions::Show::distortion}) {
        options.show = show;
        set_thread_count(1);
        const MethodSheet one = sheet();
        set_thread_count(3);
        const MethodSheet three = sheet();
        set_thread_count(0);
        EXPECT_EQ(one.image.pixels.size(), three.image.pixels.size());
        EXPECT_EQ(cv::norm(one.image.pixels, three.image.pixels, cv::NORM_INF), 0);
    }
}

TEST_F(MethodSheets, KeepTheAskedOrderAndColumns) {
    options.methods = {"harmonic", "arap (spokes)", "biharmonic"};
    options.columns = 2;
    const MethodSheet made = sheet();
    ASSERT_EQ(made.methods.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(made.methods[i].label, options.methods[i]);
    EXPECT_EQ(made.columns, 2);
    EXPECT_EQ(made.rows, 2);
}

TEST_F(MethodSheets, RestPoseHasNoDistortion) {
    pose = Pose();
    for (const MethodResult& result : sheet().methods) {
        EXPECT_EQ(result.report.distortion.flipped_triangles, 0) << result.label;
        EXPECT_NEAR(result.report.distortion.max_stretch, 1, 1e-6) << result.label;
    }
}

TEST_F(MethodSheets, AMethodThatCannotTakeThePoseSaysSoInItsCell) {
    pose.handles["right"] = HandlePose();
    pose.handles["right"].affine = {1, 0, 0.3, 1, 0, 0};  // which as-rigid-as-possible has no use for
    options.methods = {"arap", "biharmonic"};
    const MethodSheet mixed = sheet();
    EXPECT_THAT(mixed.methods[0].error, HasSubstr("right"));
    EXPECT_EQ(mixed.methods[1].error, "");
    options.methods = {"arap", "arap (spokes)"};
    EXPECT_THAT(refusal(), HasSubstr("right"));
}

TEST_F(MethodSheets, RefuseWhatCannotBeDrawn) {
    options.methods = {"arap", "magic"};
    EXPECT_THAT(refusal(), testing::AllOf(HasSubstr("magic"), HasSubstr("known: "), HasSubstr("biharmonic")));
    options.methods = {"arap", "arap"};
    EXPECT_THAT(refusal(), HasSubstr("twice"));
    options.methods.clear();
    for (const int size : {-1, 0, 119, 2001}) {
        options.cell_px = size;
        EXPECT_THAT(refusal(), HasSubstr("cell size")) << size;
    }
    options.cell_px = 120;
    for (const int columns : {-1, 65}) {
        options.columns = columns;
        EXPECT_THAT(refusal(), HasSubstr("columns")) << columns;
    }
    options.columns = 0;
    options.read.max_pixels = 90 * 60;
    EXPECT_THAT(refusal(), HasSubstr("sheet"));
    puppet.rig.handles.clear();
    pose.handles.clear();
    EXPECT_THAT(refusal(), HasSubstr("no handles"));
}

TEST_F(MethodSheets, CanBeCancelled) {
    class Stop final : public Progress {
    public:
        bool cancelled() const override { return true; }
    } stop;
    EXPECT_THROW(compare_methods(puppet, pose, options, stop), Cancelled);
}

}  // namespace
}  // namespace puppetwarp
