#include "model/pin_tool.h"

#include "model/puppet_edits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

namespace puppetwarp::ui {
namespace {

using Change = PinTool::Change;
using testing::ElementsAre;

class PinToolTest : public testing::Test {
protected:
    Change press(const Point& at) { return tool.press(at, at, "wave", px); }
    Point target(const std::string& id) const {
        for (const Pin& pin : pins(history.current(), pose_or_rest(history.current(), "wave")))
            if (pin.id == id) return pin.to;
        ADD_FAILURE() << "no pin " << id;
        return {0, 0};
    }
    std::vector<std::string> ids() const {
        std::vector<std::string> result;
        for (const Handle& handle : history.current().rig.handles) result.push_back(handle.id);
        return result;
    }
    void set_pin(const Point& at) {
        press(at);
        tool.release();
    }

    const double px = 0.5;  // image pixels a screen point: everything is shown at twice its size
    History<Puppet> history{Puppet{}};
    PinTool tool{history};
};

TEST_F(PinToolTest, AClickSetsAPinAndPicksIt) {
    EXPECT_EQ(press({10, 20}), Change::settled);
    EXPECT_EQ(tool.release(), Change::none);
    EXPECT_THAT(ids(), ElementsAre("pin1"));
    EXPECT_EQ(tool.selected(), "pin1");
    EXPECT_EQ(target("pin1"), Point(10, 20));
    EXPECT_TRUE(history.current().poses.empty()) << "at rest there is nothing to say in a pose";
    history.undo();
    EXPECT_TRUE(ids().empty());
    EXPECT_EQ(tool.selected(), "");
}

TEST_F(PinToolTest, OutsideTheSubjectAClickSetsNothing) {
    set_pin({10, 20});
    EXPECT_EQ(tool.press({200, 200}, std::nullopt, "wave", px), Change::none);
    EXPECT_THAT(ids(), ElementsAre("pin1"));
    EXPECT_EQ(tool.selected(), "") << "a click beside everything lets go of the pin";
}

TEST_F(PinToolTest, OnAMovedPictureThePinHoldsWhatIsSeen) {
    tool.press({50, 60}, Point(30, 40), "wave", px);
    tool.release();
    const auto list = pins(history.current(), pose_or_rest(history.current(), "wave"));
    ASSERT_EQ(list.size(), 1u);
    EXPECT_EQ(list[0].at, Point(30, 40));
    EXPECT_EQ(list[0].to, Point(50, 60));
}

TEST_F(PinToolTest, OneDragIsOneStep) {
    set_pin({10, 20});
    EXPECT_EQ(press({11, 20}), Change::none);  // one pixel beside its middle
    for (int i = 0; i <= 40; ++i) tool.move({11.0 + i, 20.0 + i / 2.0});
    EXPECT_TRUE(tool.dragging());
    EXPECT_EQ(target("pin1"), Point(50, 40)) << "it follows by the pointer's way, not to the pointer";
    EXPECT_EQ(tool.release(), Change::settled);
    EXPECT_EQ(history.undo_name(), "Move pin");
    history.undo();
    EXPECT_EQ(target("pin1"), Point(10, 20));
    history.redo();
    EXPECT_EQ(target("pin1"), Point(50, 40));
    history.undo();
    history.undo();
    EXPECT_FALSE(history.can_undo());
}

TEST_F(PinToolTest, AShakyClickMovesNothing) {
    set_pin({10, 20});
    press({10, 20});
    EXPECT_EQ(tool.move({11, 20}), Change::none);  // two screen points
    EXPECT_EQ(tool.release(), Change::none);
    EXPECT_EQ(target("pin1"), Point(10, 20));
    EXPECT_EQ(history.undo_name(), "Add pin");
}

TEST_F(PinToolTest, ACancelledDragLeavesNoTrace) {
    set_pin({10, 20});
    press({10, 20});
    EXPECT_EQ(tool.move({90, 90}), Change::live);
    EXPECT_EQ(tool.cancel(), Change::settled);
    EXPECT_EQ(target("pin1"), Point(10, 20));
    EXPECT_EQ(tool.move({95, 95}), Change::none);
    EXPECT_EQ(tool.release(), Change::none);
    EXPECT_EQ(history.undo_name(), "Add pin");
    EXPECT_FALSE(history.can_redo());
}

TEST_F(PinToolTest, TheGrabRadiusIsMeasuredOnTheScreen) {
    set_pin({10, 20});
    const double reach = PinTool::grab_radius * px;
    EXPECT_EQ(tool.pin_at({10 + reach * 0.99, 20}, "wave", px), "pin1");
    EXPECT_EQ(tool.pin_at({10 + reach * 1.01, 20}, "wave", px), "");
    EXPECT_EQ(tool.pin_at({10 + reach * 1.01, 20}, "wave", px * 2), "pin1");
}

TEST_F(PinToolTest, OfTwoPinsTheNearerOneIsTaken) {
    set_pin({10, 20});
    set_pin({18, 20});
    EXPECT_EQ(tool.pin_at({13, 20}, "wave", px), "pin1");
    EXPECT_EQ(tool.pin_at({15, 20}, "wave", px), "pin2");
}

TEST(PuppetEditsTest, RemovingAPinTakesItOutOfEveryPose) {
    Puppet puppet;
    const std::string a = add_pin(puppet, "one", {1, 1}, {2, 2});
    const std::string b = add_pin(puppet, "two", {5, 5}, {6, 6});
    move_pin(puppet, "two", a, {3, 3});
    puppet.rig.handles.push_back({"arm", BoneHandle{{0, 0}, {1, 0}, b}});
    remove_handle(puppet, a);
    remove_handle(puppet, b);
    ASSERT_EQ(puppet.poses.size(), 2u);
    for (const Pose& pose : puppet.poses) EXPECT_TRUE(pose.handles.empty());
    ASSERT_EQ(puppet.rig.handles.size(), 1u);
    EXPECT_EQ(std::get<BoneHandle>(puppet.rig.handles[0].shape).parent, "");
}

TEST(PuppetEditsTest, IdsAreNeverUsedTwice) {
    Puppet puppet;
    puppet.rig.handles.push_back({"pin2", PointHandle{{9, 9}, {}}});
    const std::string a = add_pin(puppet, "pose", {1, 1}, {1, 1});
    const std::string b = add_pin(puppet, "pose", {2, 2}, {2, 2});
    remove_handle(puppet, a);
    const std::string c = add_pin(puppet, "pose", {3, 3}, {3, 3});
    EXPECT_NE(a, "pin2");
    EXPECT_NE(b, a);
    EXPECT_NE(c, b);
    EXPECT_NE(c, "pin2");
}

TEST(PuppetEditsTest, MovingAPinKeepsWhatElseThePoseSaysOfIt) {
    Puppet puppet;
    const std::string id = add_pin(puppet, "pose", {1, 1}, {1, 1});
    HandlePose pose;
    pose.rotate_rad = 0.5;
    puppet.poses.push_back({"pose", 2, {{id, pose}}});
    move_pin(puppet, "pose", id, {7, 7});
    EXPECT_EQ(puppet.poses[0].handles.at(id).rotate_rad, 0.5);
    EXPECT_EQ(puppet.poses[0].time_s, 2);
    clear_pose(puppet, "pose");
    EXPECT_TRUE(puppet.poses[0].handles.empty());
}

TEST_F(PinToolTest, TheTurnsOfADragArePartOfItsStep) {
    set_pin({10, 20});
    press({10, 20});
    tool.move({30, 40});
    tool.release({{"pin1", 2 * std::numbers::pi}});
    const auto turn = [&] { return pose_or_rest(history.current(), "wave").handles["pin1"].turn_rad; };
    EXPECT_EQ(turn(), 2 * std::numbers::pi);
    history.undo();
    EXPECT_EQ(turn(), std::nullopt);
    EXPECT_EQ(target("pin1"), Point(10, 20));
}

TEST(PuppetEditsTest, TurnsAreToldOfAllFreePointsWhenOneWentFar) {
    constexpr double degree = std::numbers::pi / 180;
    Pose pose{"pose", 0, {}};
    pose.handles["fixed"].rotate_rad = 1;
    pose.handles["moved"].to = Point(1, 2);
    const Pose far = with_turns(pose, {{"fixed", 5}, {"moved", 31.4 * degree}, {"still", -0.6 * degree}});
    EXPECT_DOUBLE_EQ(*far.handles.at("moved").turn_rad, 31 * degree);
    EXPECT_DOUBLE_EQ(*far.handles.at("still").turn_rad, -degree);
    EXPECT_FALSE(far.handles.at("fixed").turn_rad);
    const Pose near = with_turns(far, {{"fixed", 5}, {"moved", 29 * degree}, {"still", 0}});
    EXPECT_FALSE(near.handles.at("moved").turn_rad);
    EXPECT_EQ(near.handles.size(), 2u) << "of what stands still there is nothing left to say";
    EXPECT_EQ(with_turns(far, {}).handles.at("moved").turn_rad, far.handles.at("moved").turn_rad)
        << "a method that follows no turns knows nothing better";
}

TEST(PuppetEditsTest, APoseIsMadeForTurnsOnlyWhenThereAreSome) {
    Puppet puppet;
    add_pin(puppet, "pose", {1, 1}, {1, 1});
    keep_turns(puppet, "pose", {{"pin1", 0.1}});
    EXPECT_TRUE(puppet.poses.empty());
    keep_turns(puppet, "pose", {{"pin1", 1}});
    ASSERT_EQ(puppet.poses.size(), 1u);
    EXPECT_TRUE(puppet.poses[0].handles.at("pin1").turn_rad);
}

}  // namespace
}  // namespace puppetwarp::ui
