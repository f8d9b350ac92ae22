#include "support/run_command.h"
#include "ui/driven_model.h"

#include <puppetwarp/image/write.h>
#include <puppetwarp/project/pipeline.h>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include <cmath>
#include <numbers>

namespace puppetwarp::ui {
namespace {

namespace fs = std::filesystem;
using tests::TemporaryFolder;

// The editor on one of the samples, its poses taken out.
class DragTest : public DrivenModel {
protected:
    using DrivenModel::DrivenModel;
    void open_sample(const std::string& name) {
        Puppet puppet = read_puppet(fs::path(PUPPETWARP_SOURCE_DIR) / "images" / (name + ".puppet.json"));
        puppet.poses.clear();
        const fs::path file = folder / (name + ".puppet.json");
        write_puppet(puppet, file);
        open(file);
        settle();
    }
    Point place(const std::string& id) const {
        for (const Pin& pin : pins(editor.puppet(), editor.pose()))
            if (pin.id == id) return pin.to;
        ADD_FAILURE() << "no pin " << id;
        return {0, 0};
    }
    std::optional<double> turn_deg(const std::string& id) const {
        const Pose pose = editor.pose();
        const auto found = pose.handles.find(id);
        if (found == pose.handles.end() || !found->second.turn_rad) return {};
        return *found->second.turn_rad * 180 / std::numbers::pi;
    }
    // Drags a pin about a centre in steps of 10 degrees, each of which is seen.
    void drag_round(const std::string& id, const Point& centre, int degrees) {
        const Point from = place(id);
        editor.press(from, image_px_per_point);
        const int step = degrees < 0 ? -10 : 10;
        for (int angle = step; angle != degrees + step; angle += step) {
            const Eigen::Rotation2Dd turn(angle * std::numbers::pi / 180);
            editor.move(centre + turn * (from - centre));
            follow();
        }
        editor.release();
        settle();
    }
    // What the command makes of the file that the editor writes.
    Eigen::MatrixX2d rendered_file() {
        const fs::path file = folder / "saved.puppet.json";
        EXPECT_TRUE(editor.save_as(file));
        const Puppet saved = read_puppet(file);
        Progress progress;
        return render(saved, find_pose(saved, editor.pose_name()), {}, progress).moved;
    }
    double off_px(const Eigen::MatrixX2d& V) const { return (editor.shape()->moved - V).rowwise().norm().maxCoeff(); }

    TemporaryFolder folder;
};

// As in the window: where a drag ends depends on how far each step came in its time.
class TimedDragTest : public DragTest {
protected:
    TimedDragTest() : DragTest(Pace{}) {}
};

// What the eye cannot tell apart.
constexpr double same_px = 0.5;
const Point gingerbread_shoulder(520, 410);

TEST_F(DragTest, TwiceRoundTheShoulderTheFileRendersWhatIsShown) {
    for (const Method method : {Method::arap, Method::smooth_arap}) {
        for (const int degrees : {720, 510, -720}) {
            SCOPED_TRACE(method_name(method) + " " + std::to_string(degrees));
            open_sample("gingerbread");
            editor.set_method(method);
            settle();
            drag_round("right hand", gingerbread_shoulder, degrees);
            ASSERT_EQ(editor.shape()->error, "");
            EXPECT_LE(editor.shape()->jump_px, same_px) << "letting go of the pin moves the picture";
            EXPECT_TRUE(editor.shape()->warnings.empty());
            ASSERT_TRUE(turn_deg("right hand"));
            EXPECT_NEAR(*turn_deg("right hand"), degrees, 20);
            EXPECT_EQ(*turn_deg("right hand"), std::round(*turn_deg("right hand")));
            EXPECT_TRUE(turn_deg("left foot")) << "points that stayed have no target, but their way is told too";
            EXPECT_LE(off_px(rendered_file()), same_px);
        }
    }
}

TEST_F(DragTest, WhereTheDragCannotBeKeptTheFileIsShown) {
    for (const int degrees : {360, 510, -520}) {
        open_sample("figure");
        editor.set_method(Method::fold_free);
        settle();
        drag_round("right hand", place("right elbow"), degrees);
        ASSERT_EQ(editor.shape()->error, "");
        EXPECT_EQ(editor.shape()->jump_px > same_px, !editor.shape()->warnings.empty());
        EXPECT_EQ(editor.shape()->distortion.flipped_triangles, 0);
        EXPECT_LE(off_px(rendered_file()), same_px) << degrees;
    }
}

TEST_F(TimedDragTest, WhereverTheDragEndsTheFileIsShownAndAJumpIsTold) {
    for (const int degrees : {510, -720}) {
        open_sample("gingerbread");
        editor.set_method(Method::smooth_arap);
        settle();
        drag_round("right hand", gingerbread_shoulder, degrees);
        ASSERT_EQ(editor.shape()->error, "");
        EXPECT_EQ(editor.shape()->jump_px > same_px, !editor.shape()->warnings.empty());
        EXPECT_LE(off_px(rendered_file()), same_px) << degrees;
    }
}

TEST_F(DragTest, TheTurnBelongsToTheStepOfTheDrag) {
    open_sample("gingerbread");
    const Eigen::MatrixX2d before = editor.shape()->moved;
    drag_round("right hand", gingerbread_shoulder, 510);
    const Eigen::MatrixX2d after = editor.shape()->moved;
    const std::optional<double> turn = turn_deg("right hand");
    ASSERT_TRUE(turn);
    editor.undo();
    settle();
    EXPECT_FALSE(editor.can_undo());
    EXPECT_FALSE(turn_deg("right hand"));
    EXPECT_EQ(editor.shape()->moved, before);
    editor.redo();
    settle();
    EXPECT_EQ(turn_deg("right hand"), turn);
    EXPECT_EQ(editor.shape()->moved, after);
    EXPECT_LE(off_px(rendered_file()), same_px);
}

TEST_F(DragTest, SmallTurnsAreNotTold) {
    open_sample("gingerbread");
    editor.set_method(Method::smooth_arap);
    settle();
    drag_round("right hand", gingerbread_shoulder, 20);
    const Pose pose = editor.pose();
    ASSERT_EQ(pose.handles.size(), 1u);
    EXPECT_FALSE(pose.handles.at("right hand").turn_rad);
    drag_round("right hand", gingerbread_shoulder, 80);
    EXPECT_TRUE(turn_deg("right hand"));
    drag_round("right hand", gingerbread_shoulder, -90);
    EXPECT_FALSE(turn_deg("right hand")) << "turned back";
    EXPECT_EQ(editor.pose().handles.size(), 1u);
}

TEST_F(DragTest, APinSetOnALimbThatWentRoundTurnsWithIt) {
    for (const Method method : {Method::arap, Method::smooth_arap}) {
        SCOPED_TRACE(method_name(method));
        open_sample("gingerbread");
        editor.set_method(method);
        settle();
        drag_round("right hand", gingerbread_shoulder, 510);
        const Eigen::MatrixX2d before = editor.shape()->moved;
        Eigen::Index wrist;
        (editor.shape()->mesh->V.rowwise() - Eigen::RowVector2d(610, 405)).rowwise().norm().minCoeff(&wrist);
        click(before.row(wrist).transpose());
        const std::string added = editor.tool().selected();
        ASSERT_EQ(editor.puppet().rig.handles.size(), 8u);
        ASSERT_EQ(editor.shape()->error, "");
        EXPECT_LT(off_px(before), 1) << "a disc instead of a triangle holds the place";
        EXPECT_LE(editor.shape()->jump_px, same_px);
        ASSERT_TRUE(turn_deg(added));
        EXPECT_NEAR(*turn_deg(added), *turn_deg("right hand"), 30);
        drag_round(added, place("right hand"), 20);
        EXPECT_LE(editor.shape()->jump_px, same_px);
        EXPECT_LE(off_px(rendered_file()), same_px);
        editor.remove_pin(added);
        settle();
        EXPECT_LE(editor.shape()->jump_px, same_px);
        EXPECT_LE(off_px(before), same_px) << "the way is that of the first drag still";
        EXPECT_LE(off_px(rendered_file()), same_px);
    }
}

TEST_F(DragTest, EveryMethodShowsWhatItRenders) {
    open_sample("gingerbread");
    drag_round("right hand", gingerbread_shoulder, 90);
    const std::optional<double> turn = turn_deg("right hand");
    for (const std::string& name : method_names()) {
        SCOPED_TRACE(name);
        editor.set_method(method_from_name(name));
        settle();
        ASSERT_EQ(editor.shape()->error, "");
        EXPECT_LE(off_px(rendered_file()), same_px);
        EXPECT_EQ(turn_deg("right hand"), turn) << "looking through the methods loses nothing";
    }
    MethodOptions options;
    options.method = Method::smooth_arap;
    options.bending_length_px = 90;
    const Eigen::MatrixX2d before = editor.shape()->moved;
    editor.set_method_options("Change bending length", options);
    settle();
    EXPECT_GT(off_px(before), 1);
    EXPECT_LE(off_px(rendered_file()), same_px);
    EXPECT_EQ(editor.history().undo_name(), "Change bending length");
}

TEST_F(DragTest, WhileThePinRestsThePictureSettles) {
    open_sample("figure");
    const Point hand = place("right hand");
    editor.press(hand, image_px_per_point);
    editor.move(hand + Point(-300, -60));
    follow();
    EXPECT_TRUE(editor.shape()->converged);
    EXPECT_TRUE(editor.shape()->live);
    const Eigen::MatrixX2d settled = editor.shape()->moved;
    editor.release();
    settle();
    EXPECT_LE(off_px(settled), same_px);
}

TEST_F(DragTest, WhatCannotBeDraggedLeavesTheLastGoodShape) {
    Puppet puppet = read_puppet(fs::path(PUPPETWARP_SOURCE_DIR) / "images" / "gingerbread.puppet.json");
    puppet.poses.clear();
    puppet.rig.handles.push_back({"twin", std::get<PointHandle>(puppet.rig.handles.front().shape)});
    write_puppet(puppet, folder / "twins.puppet.json");
    open(folder / "twins.puppet.json");
    settle();
    ASSERT_EQ(editor.shape()->error, "");
    drag_round("right hand", gingerbread_shoulder, 30);
    const Eigen::MatrixX2d good = editor.shape()->moved;
    editor.press(place("head"), image_px_per_point);
    editor.move(place("head") + Point(60, 0));
    follow();
    EXPECT_NE(editor.shape()->error, "");
    EXPECT_LE(off_px(good), same_px);
    editor.cancel();
    settle();
    EXPECT_EQ(editor.shape()->error, "");
    EXPECT_EQ(editor.shape()->moved, good);
}

TEST_F(DragTest, APartWithoutAHandleIsToldOf) {
    Image blobs;
    blobs.pixels = cv::Mat(80, 160, CV_8UC4, cv::Scalar::all(0));
    for (const int left : {10, 90}) blobs.pixels(cv::Rect(left, 10, 60, 60)).setTo(cv::Scalar(200, 90, 30, 255));
    write_image(blobs, folder / "blobs.png");
    open(folder / "blobs.png");
    click({40, 40});
    ASSERT_EQ(editor.shape()->error, "");
    ASSERT_EQ(editor.shape()->warnings.size(), 1u);
    EXPECT_NE(editor.shape()->warnings.front().find("handle"), std::string::npos) << editor.shape()->warnings.front();
    click({120, 40});
    EXPECT_TRUE(editor.shape()->warnings.empty());
}

}  // namespace
}  // namespace puppetwarp::ui
