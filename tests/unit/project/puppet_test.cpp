#include "support/run_command.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/project/puppet.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <numbers>

namespace puppetwarp {
namespace {

using Json = nlohmann::ordered_json;
using tests::TemporaryFolder;

// Every field that the format has and this version reads, with unknown keys on every level.
const char* const full_document = R"({
  "format": "puppetwarp",
  "version": 1,
  "image": "gingerbread.png",
  "cutout": {
    "from": "polygon",
    "points": [[0, 0], [200, 0], [200, 300.25]],
    "holes": [
      [[50, 50], [60, 50], [55, 60]]
    ],
    "feather_px": 3
  },
  "background": "#10203040",
  "back_faces": "show",
  "mesh": {
    "max_edge_px": 12,
    "min_angle_deg": 25,
    "expand_px": 2,
    "note": "fine"
  },
  "handles": [
    {
      "id": "hand",
      "type": "point",
      "at": [120.5, 88],
      "radius_px": 9.5,
      "colour": "red"
    },
    {
      "id": "spine",
      "type": "bone",
      "from": [90, 90],
      "to": [118, 88]
    },
    {
      "id": "arm",
      "type": "bone",
      "from": [118, 88],
      "to": [140, 88],
      "parent": "spine"
    },
    {
      "id": "hull",
      "type": "cage",
      "points": [[0, 0], [200, 0], [200, 300], [0, 300]]
    },
    {
      "id": "torso",
      "type": "region",
      "points": [[60, 60], [90, 60], [90, 120], [60, 120]],
      "falloff": "geodesic"
    },
    {
      "id": "v7",
      "type": "vertex",
      "index": 7
    }
  ],
  "stiffness": [
    {
      "points": [[60, 60], [90, 60], [90, 120]],
      "value": 8,
      "why": "bone"
    },
    {
      "image": "stiff.png",
      "max": 20,
      "painted_by": "hand"
    }
  ],
  "method": {
    "name": "arap",
    "arap_energy": "spokes-and-rims",
    "bending_length_px": 12.5,
    "stretching": 0.25,
    "bending": 3,
    "tolerance": 1e-06,
    "max_iterations": 50,
    "later": true
  },
  "poses": [
    {
      "name": "wave",
      "time_s": 0,
      "handles": {
        "hand": {
          "to": [150, 30],
          "rotate_deg": 20,
          "scale": 1.2,
          "depth": 1,
          "ease": "in"
        },
        "arm": {
          "from": [1, 2],
          "to": [3, 4]
        },
        "hull": {
          "to": [[0, 0], [220, 10], [200, 300], [0, 300]]
        }
      },
      "mood": "good"
    },
    {
      "name": "bow",
      "time_s": 1.5,
      "handles": {
        "hand": {
          "turn_deg": -400.5
        },
        "torso": {
          "affine": [1, 0, 0.5, 1, 10, -20]
        }
      }
    }
  ],
  "author": {
    "name": "someone"
  }
}
)";

Puppet parse(const std::string& text) {
    return parse_puppet(text, "test");
}

TEST(Puppet, EveryFieldIsRead) {
    const Puppet puppet = parse(full_document);
    EXPECT_EQ(puppet.image, "gingerbread.png");
    EXPECT_EQ(puppet.cutout.from, "polygon");
    EXPECT_EQ(puppet.cutout.points[2], Point(200, 300.25));
    EXPECT_EQ(puppet.cutout.holes.at(0).at(2), Point(55, 60));
    EXPECT_EQ(puppet.background, "#10203040");
    EXPECT_EQ(puppet.back_faces, BackFaces::show);
    EXPECT_EQ(puppet.mesh.max_edge_px, 12);
    ASSERT_EQ(puppet.rig.handles.size(), 6u);
    EXPECT_EQ(std::get<PointHandle>(puppet.rig.handles[0].shape).radius_px, 9.5);
    EXPECT_EQ(std::get<BoneHandle>(puppet.rig.handles[2].shape).parent, "spine");
    EXPECT_EQ(std::get<VertexHandle>(puppet.rig.handles[5].shape).index, 7);
    EXPECT_EQ(std::get<StiffnessRegion>(puppet.rig.stiffness.at(0)).value, 8);
    EXPECT_EQ(std::get<StiffnessPicture>(puppet.rig.stiffness.at(1)).path, "stiff.png");
    EXPECT_EQ(std::get<StiffnessPicture>(puppet.rig.stiffness.at(1)).max, 20);
    EXPECT_EQ(std::get<RegionHandle>(puppet.rig.handles[4].shape).falloff, Falloff::geodesic);
    EXPECT_EQ(puppet.method.bending_length_px, 12.5);
    EXPECT_EQ(puppet.method.stretching, 0.25);
    EXPECT_EQ(puppet.method.bending, 3);
    EXPECT_NEAR(*puppet.poses.at(1).handles.at("hand").turn_rad, -400.5 * std::numbers::pi / 180, 1e-13);
    EXPECT_EQ(puppet.method.arap_energy, ArapEnergy::spokes_and_rims);
    EXPECT_EQ(puppet.method.max_iterations, 50);
    const HandlePose& hand = puppet.poses.at(0).handles.at("hand");
    EXPECT_NEAR(*hand.rotate_rad, std::numbers::pi / 9, 1e-15);
    EXPECT_EQ(hand.scale, 1.2);
    EXPECT_EQ(hand.depth, 1);
    EXPECT_EQ(puppet.poses.at(0).handles.at("hull").points->at(1), Point(220, 10));
    EXPECT_EQ(puppet.poses.at(1).time_s, 1.5);
    EXPECT_EQ(puppet.poses.at(1).handles.at("torso").affine->at(5), -20);
}

TEST(Puppet, LoadAndSaveKeepsEverything) {
    EXPECT_EQ(to_json(parse(full_document)), full_document);
}

TEST(Puppet, ClearedFieldsAreGoneUnknownOnesStay) {
    Puppet puppet = parse(full_document);
    puppet.poses[0].handles["hand"].rotate_rad.reset();
    puppet.background.reset();
    puppet.back_faces = BackFaces::hide;
    puppet.rig.handles.erase(puppet.rig.handles.begin() + 5);
    const Json json = Json::parse(to_json(puppet));
    EXPECT_FALSE(json["poses"][0]["handles"]["hand"].contains("rotate_deg"));
    EXPECT_EQ(json["poses"][0]["handles"]["hand"]["ease"], "in");
    EXPECT_FALSE(json.contains("background"));
    EXPECT_FALSE(json.contains("back_faces"));
    EXPECT_EQ(json["handles"].size(), 5u);
    EXPECT_EQ(json["author"]["name"], "someone");
}

TEST(Puppet, DefaultsNeedOnlyFormatAndVersion) {
    const Puppet puppet = parse(R"({"version": 1, "format": "puppetwarp"})");
    EXPECT_EQ(puppet.cutout.from, "auto");
    EXPECT_EQ(puppet.method.method, Method::arap);
    EXPECT_EQ(default_pose(puppet).name, "rest");
    EXPECT_TRUE(default_pose(puppet).handles.empty());
    const Puppet again = parse(to_json(puppet));
    EXPECT_EQ(to_json(again), to_json(puppet));
}

TEST(Puppet, AnglesComeBackAsTyped) {
    for (const double degrees : {20.0, -170.0, 0.1, 33.3333, 720.5}) {
        const std::string text = Json(degrees).dump();
        for (const char* key : {"rotate_deg", "turn_deg"}) {
            const Puppet puppet = parse(R"({"format": "puppetwarp", "version": 1,
                "handles": [{"id": "a", "type": "point", "at": [1, 2]}],
                "poses": [{"name": "p", "handles": {"a": {")" +
                                        std::string(key) + "\": " + text + "}}}]}");
            EXPECT_EQ(Json::parse(to_json(puppet))["poses"][0]["handles"]["a"][key].get<double>(), degrees);
        }
    }
}

TEST(Puppet, PosesByName) {
    const Puppet puppet = parse(full_document);
    EXPECT_EQ(default_pose(puppet).name, "wave");
    EXPECT_EQ(find_pose(puppet, "bow").time_s, 1.5);
    EXPECT_TRUE(find_pose(puppet, "rest").handles.empty());
    try {
        find_pose(puppet, "jump");
        FAIL();
    } catch (const InvalidInput& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("wave, bow"));
    }
}

TEST(Puppet, PathsFollowTheFile) {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "a");
    std::filesystem::create_directories(folder.path() / "b/c");
    tests::put_bytes(folder / "a/one.json", R"({"format": "puppetwarp", "version": 1, "image": "pictures/x.png",
        "cutout": {"from": "mask", "path": "../m.png"}, "stiffness": [{"image": "s.png", "max": 3}]})");
    const Puppet puppet = read_puppet(folder / "a/one.json");
    EXPECT_EQ(resolve(puppet, puppet.image), folder.path() / "a/pictures/x.png");
    write_puppet(puppet, folder / "b/c/two.json");
    const Puppet moved = read_puppet(folder / "b/c/two.json");
    EXPECT_EQ(moved.image, "../../a/pictures/x.png");
    EXPECT_EQ(moved.cutout.path, "../../m.png");
    EXPECT_EQ(std::get<StiffnessPicture>(moved.rig.stiffness.at(0)).path, "../../a/s.png");
    write_puppet(puppet, folder / "a/three.json");
    EXPECT_EQ(read_puppet(folder / "a/three.json").image, "pictures/x.png");
}

TEST(Puppet, TheFuzzersCorpusIsReadAndSavedAlike) {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(PUPPETWARP_SOURCE_DIR "/tests/fuzz/corpus/puppet")) {
        const std::string saved = to_json(read_puppet(entry.path()));
        EXPECT_EQ(to_json(parse(saved)), saved) << entry.path();
        ++count;
    }
    EXPECT_GE(count, 3);
}

TEST(Puppet, MistakesNameTheirField) {
    const auto complaint = [](const std::string& text) -> std::string {
        try {
            parse(text);
        } catch (const InvalidInput& error) {
            return error.what();
        }
        return "nothing";
    };
    const std::string head = R"({"format": "puppetwarp", "version": 1, )";
    EXPECT_THAT(complaint(head + R"("handles": [{"id": "a", "type": "bone", "from": [0, 0], "to": [1, "x"]}]})"),
                testing::HasSubstr("handles[0].to[1] must be a number, but is text"));
    EXPECT_THAT(complaint(head + R"("handles": [{"id": "a", "type": "point", "at": [0, 0]},
                                               {"id": "a", "type": "point", "at": [9, 9]}]})"),
                testing::HasSubstr("a"));
    EXPECT_THAT(
        complaint(head + R"("handles": [{"id": "a", "type": "bone", "from": [0, 0], "to": [1, 0], "parent": "b"},
                                               {"id": "b", "type": "bone", "from": [0, 0], "to": [1, 0], "parent": "a"}]})"),
        testing::HasSubstr("parent"));
    EXPECT_THAT(complaint(head + R"("poses": [{"name": "rest"}]})"), testing::HasSubstr("poses[0].name"));
    EXPECT_THAT(complaint(head + R"("poses": [{"name": "a"}, {"name": "a"}]})"), testing::HasSubstr("poses[1]"));
    EXPECT_THAT(complaint(head + R"("back_faces": "both"})"),
                testing::AllOf(testing::HasSubstr("back_faces"), testing::HasSubstr("hide or show")));
    EXPECT_THAT(complaint(head + R"("handles": [{"id": "a", "type": "point", "at": [0, 0]}],
                                    "poses": [{"name": "p", "handles": {"a": {"depth": 1e7}}}]})"),
                testing::HasSubstr("depth"));
    EXPECT_THAT(complaint(head + R"("cutout": {"from": "mask"}})"),
                testing::HasSubstr("cutout lacks the field `path`"));
    EXPECT_THAT(complaint(head + R"("stiffness": [{"image": "s.png"}]})"),
                testing::HasSubstr("stiffness[0] lacks the field `max`"));
    EXPECT_THAT(complaint(head + R"("stiffness": [{"image": "", "max": 2}]})"),
                testing::HasSubstr("stiffness[0].image"));
    EXPECT_THAT(complaint(head + R"("method": {"bending_length_px": 0}})"), testing::HasSubstr("bending_length_px"));
    EXPECT_THAT(complaint(head + R"("method": {"stretching": -1}})"), testing::HasSubstr("method.stretching"));
    EXPECT_THAT(
        complaint(head + R"("handles": [{"id": "r", "type": "region", "points": [[0, 0], [1, 0], [0, 1]],
                                               "falloff": "steep"}]})"),
        testing::AllOf(testing::HasSubstr("handles[0].falloff"), testing::HasSubstr("none, harmonic, geodesic")));
    EXPECT_THAT(complaint(head + R"("stiffness": [{"points": [[0, 0], [1, 0], [0, 1]], "value": 0}]})"),
                testing::HasSubstr("stiffness[0].value must be above 0"));
    EXPECT_THAT(complaint("{\n\"format\": \"puppetwarp\",\n\"version\": 1,,\n}"), testing::HasSubstr("line 3"));
}

}  // namespace
}  // namespace puppetwarp
