#include "support/message_of.h"

#include <puppetwarp/rig/rig.h>

#include <puppetwarp/base/errors.h>

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

namespace puppetwarp {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Rig rich_rig() {
    Rig rig;
    rig.handles.push_back({"hand", PointHandle{{1, 2}, 3.0}});
    rig.handles.push_back({"spine", BoneHandle{{0, 0}, {0, 5}, ""}});
    rig.handles.push_back({"arm", BoneHandle{{0, 5}, {4, 5}, "spine"}});
    rig.handles.push_back({"hull", CageHandle{{{0, 0}, {9, 0}, {9, 9}}}});
    rig.handles.push_back({"torso", RegionHandle{{{1, 1}, {2, 1}, {2, 2}}}});
    rig.handles.push_back({"v7", VertexHandle{7}});
    rig.stiffness.push_back(StiffnessRegion{{{0, 0}, {1, 0}, {1, 1}}, 8});
    return rig;
}

std::string rig_message(const std::function<void(Rig&)>& change) {
    Rig rig = rich_rig();
    change(rig);
    return message_of([&] { require_sound(rig); });
}

std::string pose_message(const std::string& id, const HandlePose& target) {
    Pose pose;
    pose.name = "wave";
    pose.handles[id] = target;
    return message_of([&] { require_sound(pose, rich_rig()); });
}

HandlePose made(const std::function<void(HandlePose&)>& fill) {
    HandlePose pose;
    fill(pose);
    return pose;
}

TEST(Rig, FindsHandlesById) {
    const Rig rig = rich_rig();
    EXPECT_EQ(find_handle(rig, "hull"), &rig.handles[3]);
    EXPECT_EQ(find_handle(rig, "tail"), nullptr);
}

TEST(Rig, AcceptsEveryKindOfHandle) {
    EXPECT_EQ(rig_message([](Rig&) {}), "");
}

TEST(Rig, NamesTheHandleAndTheField) {
    const double nan = std::nan("");
    EXPECT_THAT(rig_message([](Rig& r) { r.handles[2].id = ""; }), HasSubstr("handle 2: its id is empty"));
    EXPECT_THAT(rig_message([](Rig& r) { r.handles[2].id = "hand"; }), AllOf(HasSubstr("'hand'"), HasSubstr("twice")));
    EXPECT_THAT(rig_message([&](Rig& r) { std::get<PointHandle>(r.handles[0].shape).at.x() = nan; }),
                AllOf(HasSubstr("'hand'"), HasSubstr("at is not")));
    EXPECT_THAT(rig_message([](Rig& r) { std::get<PointHandle>(r.handles[0].shape).radius_px = 0; }),
                AllOf(HasSubstr("'hand'"), HasSubstr("radius_px")));
    EXPECT_THAT(rig_message([](Rig& r) { std::get<BoneHandle>(r.handles[2].shape).parent = "leg"; }),
                AllOf(HasSubstr("'arm'"), HasSubstr("'leg'")));
    EXPECT_THAT(rig_message([](Rig& r) { std::get<BoneHandle>(r.handles[2].shape).parent = "hand"; }),
                HasSubstr("not a bone"));
    EXPECT_THAT(rig_message([](Rig& r) { std::get<BoneHandle>(r.handles[1].shape).parent = "arm"; }),
                HasSubstr("loop"));
    EXPECT_THAT(rig_message([](Rig& r) { std::get<CageHandle>(r.handles[3].shape).points.pop_back(); }),
                AllOf(HasSubstr("'hull'"), HasSubstr("points")));
    EXPECT_THAT(rig_message([](Rig& r) { std::get<StiffnessRegion>(r.stiffness[0]).value = 0; }),
                AllOf(HasSubstr("stiffness 0"), HasSubstr("value")));
}

TEST(Pose, AcceptsWhatEachTypeHas) {
    EXPECT_EQ(pose_message("hand", made([](HandlePose& p) {
                               p.to = Point(1, 1);
                               p.rotate_rad = 1.0;
                               p.scale = 2.0;
                               p.depth = -1.0;
                           })),
              "");
    EXPECT_EQ(pose_message("hand", made([](HandlePose& p) { p.affine = std::array<double, 6>{1, 0, 0, 1, 0, 0}; })),
              "");
    EXPECT_EQ(pose_message("arm", made([](HandlePose& p) {
                               p.to = Point(1, 1);
                               p.from = Point(2, 2);
                           })),
              "");
    EXPECT_EQ(pose_message("hull", made([](HandlePose& p) { p.points = Polyline{{0, 0}, {1, 0}, {1, 1}}; })), "");
    EXPECT_EQ(pose_message("v7", made([](HandlePose& p) { p.to = Point(1, 1); })), "");
    EXPECT_EQ(pose_message("hand", made([](HandlePose& p) {
                               p.turn_rad = 9.0;
                               p.scale = 2.0;
                           })),
              "");
    EXPECT_EQ(pose_message("torso", made([](HandlePose& p) {
                               p.to = Point(1, 1);
                               p.rotate_rad = 1.0;
                           })),
              "");
}

TEST(Pose, NamesTheHandleAndTheField) {
    EXPECT_THAT(pose_message("tail", {}), AllOf(HasSubstr("'wave'"), HasSubstr("'tail'")));
    EXPECT_THAT(pose_message("hand", made([](HandlePose& p) { p.to = Point(1, INFINITY); })),
                AllOf(HasSubstr("'hand'"), HasSubstr("to is not")));
    EXPECT_THAT(pose_message("hand", made([](HandlePose& p) { p.rotate_rad = NAN; })), HasSubstr("rotate_deg"));
    EXPECT_THAT(pose_message("hand", made([](HandlePose& p) { p.scale = -1.0; })),
                AllOf(HasSubstr("scale"), HasSubstr("above 0")));
    EXPECT_THAT(pose_message("hand", made([](HandlePose& p) { p.from = Point(0, 0); })),
                HasSubstr("a point does not have 'from'"));
    EXPECT_THAT(pose_message("v7", made([](HandlePose& p) { p.rotate_rad = 1.0; })),
                HasSubstr("a vertex does not have 'rotate_deg'"));
    EXPECT_THAT(pose_message("hand", made([](HandlePose& p) { p.scale = 2e6; })), HasSubstr("scale is above"));
    EXPECT_THAT(pose_message("hand", made([](HandlePose& p) { p.turn_rad = 1e5; })), HasSubstr("turn_deg"));
    EXPECT_THAT(pose_message("arm", made([](HandlePose& p) { p.turn_rad = 1; })),
                HasSubstr("a bone does not have 'turn_deg'"));
    EXPECT_THAT(pose_message("arm", made([](HandlePose& p) {
                                 p.to = Point(1, 1);
                                 p.rotate_rad = 1.0;
                             })),
                AllOf(HasSubstr("'arm'"), HasSubstr("beside rotate_deg")));
    EXPECT_THAT(pose_message("hull", made([](HandlePose& p) {
                                 p.points = Polyline{{0, 0}, {1, 0}};
                             })),
                HasSubstr("2 points, the cage has 3"));
    EXPECT_THAT(pose_message("hand", made([](HandlePose& p) {
                                 p.to = Point(0, 0);
                                 p.affine = std::array<double, 6>{};
                             })),
                HasSubstr("affine"));
}

}  // namespace
}  // namespace puppetwarp
