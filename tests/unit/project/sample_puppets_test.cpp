#include "support/run_command.h"

#include <puppetwarp/project/pipeline.h>

#include <opencv2/core.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <complex>
#include <filesystem>
#include <numbers>
#include <set>

// What holds of every puppet file beside the samples' pictures.
namespace puppetwarp {
namespace {

namespace fs = std::filesystem;

const fs::path images = fs::path(PUPPETWARP_SOURCE_DIR) / "images";
const std::string suffix = ".puppet.json";

// `figure.bones` of images/figure.bones.puppet.json.
std::vector<std::string> sample_names() {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(images)) {
        const std::string name = entry.path().filename().string();
        if (name.size() > suffix.size() && name.ends_with(suffix)) {
            names.push_back(name.substr(0, name.size() - suffix.size()));
        }
    }
    std::sort(names.begin(), names.end());
    return names;
}

fs::path file_of(const std::string& name) {
    return images / (name + suffix);
}

TEST(SamplePuppets, AreOfPointsBonesAndACageForEachPicture) {
    const std::vector<std::string> names = sample_names();
    const std::set<std::string> all(names.begin(), names.end());
    std::size_t pictures = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator(images)) {
        if (entry.path().extension() != ".png") continue;
        ++pictures;
        const std::string stem = entry.path().stem().string();
        for (const char* kind : {"", ".bones", ".cage"}) EXPECT_TRUE(all.contains(stem + kind)) << stem << kind;
    }
    EXPECT_EQ(pictures, 6u);
    EXPECT_EQ(names.size(), 3 * pictures);
}

class SamplePuppet : public testing::TestWithParam<std::string> {
protected:
    Puppet puppet = read_puppet(file_of(GetParam()));
};

// To the byte what the program saves, so that saving after a change shows this change alone.
TEST_P(SamplePuppet, IsSavedAsItIs) {
    const std::string text = tests::bytes_of(file_of(GetParam()));
    puppet.source.clear();
    EXPECT_EQ(to_json(puppet), text);
    Puppet again = parse_puppet(to_json(puppet), "again", puppet.folder);
    again.source.clear();
    EXPECT_EQ(to_json(again), text);
}

TEST_P(SamplePuppet, MovesInEachPoseWithoutAFold) {
    ASSERT_FALSE(puppet.poses.empty());
    const Image image = load_image(puppet);
    const Cutout cutout = cut_out_subject(puppet, image);
    const TriangleMesh mesh = mesh_subject(puppet, outline_subject(puppet, image.width(), image.height(), cutout));
    Progress progress;
    const auto deformer = bound_deformer(puppet.method, mesh, puppet.rig, {}, progress);
    const double size = (mesh.V.colwise().maxCoeff() - mesh.V.colwise().minCoeff()).norm();
    for (const Pose& pose : puppet.poses) {
        SCOPED_TRACE(pose.name);
        const Deformation moved = deformer->deform(pose, nullptr, progress);
        RenderReport report;
        describe(puppet.method, mesh, puppet.rig, pose, moved, report);
        EXPECT_EQ(report.distortion.flipped_triangles, 0);
        EXPECT_TRUE(report.converged);
        EXPECT_TRUE(report.warnings.empty()) << report.warnings.front();
        EXPECT_LE(report.max_handle_error_px, 1e-6);
        EXPECT_GT((moved.V - mesh.V).rowwise().norm().maxCoeff(), 0.01 * size);  // to be seen
        RenderOptions options;
        options.interpolation = Interpolation::nearest;
        const Image drawn = draw_subject(puppet, image, cutout, mesh, moved.V, {}, options, report, progress);
        EXPECT_EQ(drawn.pixels.size(), image.pixels.size());
        EXPECT_EQ(drawn.pixels.depth(), image.pixels.depth());
    }
}

INSTANTIATE_TEST_SUITE_P(All, SamplePuppet, testing::ValuesIn(sample_names()), [](const auto& tested) {
    std::string name = tested.param;
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
    return name;
});

// The walk of the articulated figure.
class Walk : public testing::Test {
protected:
    const Pose& pose(const std::string& name) const {
        for (const Pose& each : puppet.poses) {
            if (each.name == name) return each;
        }
        throw std::runtime_error("no pose " + name);
    }
    static std::string other_side(std::string name) {
        if (name.starts_with("left")) return "right" + name.substr(4);
        if (name.starts_with("right")) return "left" + name.substr(5);
        return name;
    }

    Puppet puppet = read_puppet(file_of("figure.bones"));
    const std::vector<std::string> steps{"contact", "down", "passing", "up"};
};

TEST_F(Walk, TakesEightStepsOfOneTime) {
    ASSERT_EQ(puppet.poses.size(), 8u);
    for (std::size_t k = 0; k < 8; ++k) {
        EXPECT_EQ(puppet.poses[k].name, (k < 4 ? "left-" : "right-") + steps[k % 4]);
        EXPECT_DOUBLE_EQ(puppet.poses[k].time_s, 0.125 * static_cast<double>(k));
    }
}

// The picture is 1000 wide: what one half of the walk does on one side, the other does on the other.
TEST_F(Walk, IsTheSameOnBothFeet) {
    for (const std::string& step : steps) {
        const Pose &left = pose("left-" + step), &right = pose("right-" + step);
        EXPECT_EQ(left.handles.size(), right.handles.size());
        for (const auto& [id, target] : left.handles) {
            SCOPED_TRACE(step + ", " + id);
            const HandlePose& mirrored = right.handles.at(other_side(id));
            EXPECT_NEAR(target.rotate_rad.value_or(0), -mirrored.rotate_rad.value_or(0), 1e-12);
            for (const auto field : {&HandlePose::from, &HandlePose::reach}) {
                ASSERT_EQ((target.*field).has_value(), (mirrored.*field).has_value());
                if (!(target.*field)) continue;
                EXPECT_NEAR((target.*field)->x(), 1000 - (mirrored.*field)->x(), 1e-9);
                EXPECT_EQ((target.*field)->y(), (mirrored.*field)->y());
            }
        }
    }
}

// Measured on the moved mesh: where the ankle comes, and how the foot lies.
TEST_F(Walk, PlantsTheLeadingFoot) {
    const Image image = load_image(puppet);
    const Cutout cutout = cut_out_subject(puppet, image);
    const TriangleMesh mesh = mesh_subject(puppet, outline_subject(puppet, image.width(), image.height(), cutout));
    Progress progress;
    const auto deformer = bound_deformer(puppet.method, mesh, puppet.rig, {}, progress);
    const auto vertex_at = [&](const Point& p) {
        Eigen::Index nearest = 0;
        (mesh.V.rowwise() - p.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
        return nearest;
    };
    const Eigen::Index ankle = vertex_at({335, 1080}), toe = vertex_at({254, 1122});
    const auto foot = [&](const Eigen::MatrixX2d& V) {
        const Point along = (V.row(toe) - V.row(ankle)).transpose();
        return std::complex<double>(along.x(), along.y());
    };
    for (const std::string& step : steps) {
        SCOPED_TRACE(step);
        const Pose& now = pose("left-" + step);
        const Eigen::MatrixX2d V = deformer->deform(now, nullptr, progress).V;
        // The leg comes as far as it is long; where a step asks for a hair more, it is straight.
        EXPECT_LT((V.row(ankle).transpose() - *now.handles.at("left shin").reach).norm(), 2);
        // The heel strikes with the toe up, then the sole lies flat, at last the heel leaves the ground.
        const double turned_deg = std::arg(foot(V) / foot(mesh.V)) * 180 / std::numbers::pi;
        EXPECT_NEAR(turned_deg, step == "contact" ? 14 : step == "up" ? -10 : 0, 2);
    }
}

}  // namespace
}  // namespace puppetwarp
