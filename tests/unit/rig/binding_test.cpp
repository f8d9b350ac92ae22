#include "reference/test_meshes.h"
#include "support/message_of.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/rig/binding.h>
#include <puppetwarp/rig/snap.h>

#include <gmock/gmock.h>

#include <cmath>

namespace puppetwarp {
namespace {

using reference::rig_of_points;
using testing::AllOf;
using testing::HasSubstr;

TEST(Binding, MeanIsAverageOverTheDiscAndTurnIsThatOfASimilarity) {
    const TriangleMesh mesh = reference::grid(60, 60, 100, 100, 0.25);
    Rig rig = rig_of_points({{50, 50}, {0, 30}});
    std::get<PointHandle>(rig.handles[0].shape).radius_px = 9;
    const std::complex<double> similarity = std::polar(1.7, 0.6);
    const Eigen::VectorXcd rest = complex_positions(mesh.V);
    const Eigen::VectorXcd moved = (similarity * rest).array() + std::complex<double>(3, 4);
    for (const Hold& hold : take_hold(mesh, rig, "arap").holds) {
        double sum = 0;
        for (const auto& [vertex, weight] : hold.mean) {
            EXPECT_GT(weight.real(), 0);
            EXPECT_LT(std::abs(rest(vertex) - hold.at), hold.radius_px);
            sum += weight.real();
        }
        EXPECT_NEAR(sum, 1, 1e-13);
        EXPECT_LT(std::abs(row_value(hold.turn, rest) - 1.0), 1e-12);
        EXPECT_LT(std::abs(row_value(hold.turn, moved) - similarity), 1e-12);
    }
    // A whole disc is centred on its point but for the mesh's irregularity.
    EXPECT_LT(std::abs(row_value(take_hold(mesh, rig, "arap").holds[0].mean, rest) - std::complex<double>(50, 50)),
              0.2);
}

TEST(Binding, DoesNotReachAcrossAGap) {
    // Two bars 4 px apart, joined at the far end only.
    const auto inside = [](double x, double y) {
        return x > 0 && x < 100 && y > 0 && y < 44 && !(x < 80 && y > 20 && y < 24);
    };
    const TriangleMesh mesh = reference::shape(inside, 100, 2);
    Rig rig = rig_of_points({{10, 17}});
    std::get<PointHandle>(rig.handles[0].shape).radius_px = 12;
    const std::vector<Hold> holds = take_hold(mesh, rig, "arap").holds;
    ASSERT_GE(holds[0].mean.size(), 20u);
    for (const auto& entry : holds[0].mean) EXPECT_LT(mesh.V(entry.first, 1), 22);
}

TEST(Binding, ACoarseMeshIsHeldByTheTriangleBelow) {
    const TriangleMesh mesh = reference::grid(2, 2, 100, 100);
    const Hold hold = take_hold(mesh, rig_of_points({{30, 11}}), "arap").holds[0];
    EXPECT_LE(hold.mean.size(), 3u);
    const Eigen::VectorXcd rest = complex_positions(mesh.V);
    EXPECT_LT(std::abs(row_value(hold.mean, rest) - hold.at), 1e-12);
    EXPECT_LT(std::abs(row_value(hold.turn, rest) - 1.0), 1e-13);
}

TEST(Binding, SaysHowFarOutsideAPointLies) {
    const TriangleMesh mesh = reference::grid(10, 10, 100, 100);
    EXPECT_THAT(message_of([&] {
                    take_hold(mesh, rig_of_points({{103, 104}}), "arap");
                }),
                AllOf(HasSubstr("'p0'"), HasSubstr("lies 5 px outside the subject"), HasSubstr("--pin-snap PX")));
    EXPECT_EQ(message_of([&] { take_hold(mesh, rig_of_points({{100, 100}}), "arap"); }), "");
}

TEST(Binding, SaysWhatCannotBeUsed) {
    const TriangleMesh mesh = reference::grid(4, 4, 10, 10);
    EXPECT_THAT(message_of([&] { take_hold(mesh, Rig(), "arap"); }), HasSubstr("no handles"));
    EXPECT_THAT(message_of([&] { take_hold(mesh, reference::rig_of_vertices({25}), "arap"); }),
                AllOf(HasSubstr("'v0'"), HasSubstr("25")));
    Rig cage;
    cage.handles.push_back({"hull", CageHandle{{{0, 0}, {9, 0}, {9, 9}}}});
    EXPECT_THAT(message_of([&] { take_hold(mesh, cage, "harmonic"); }),
                AllOf(HasSubstr("'hull'"), HasSubstr("a cage cannot drive 'harmonic'")));
    Rig region;
    region.handles.push_back({"spot", RegionHandle{{{1.1, 1.1}, {1.2, 1.1}, {1.2, 1.2}}}});
    EXPECT_THAT(message_of([&] { take_hold(mesh, region, "harmonic"); }),
                AllOf(HasSubstr("'spot'"), HasSubstr("no vertex")));
    Rig bone;
    bone.handles.push_back({"arm", BoneHandle{{1, 1}, {13, 14}, ""}});
    EXPECT_THAT(message_of([&] { take_hold(mesh, bone, "harmonic"); }),
                AllOf(HasSubstr("'arm'"), HasSubstr("lies 5 px outside")));
}

TEST(Binding, TwoHandlesInOnePlaceMustAgree) {
    const TriangleMesh mesh = reference::grid(20, 20, 100, 100);
    const Rig rig = rig_of_points({{50, 50}, {20, 20}, {50, 50}});
    const Binding binding = take_hold(mesh, rig, "arap");
    const auto resolved = [&](const Pose& pose) { return resolve(binding, mesh, rig, pose, AffineUse::no, "arap"); };
    Pose pose;
    pose.handles["p0"].to = Point(60, 50);
    EXPECT_THAT(message_of([&] { resolved(pose); }), AllOf(HasSubstr("'p0' and 'p2'"), HasSubstr("one place")));
    pose.handles["p2"].to = Point(60, 50);
    // One hold for both, which moves as both say.
    ASSERT_EQ(binding.holds.size(), 2u);
    EXPECT_EQ(resolved(pose).holds[0].move, std::complex<double>(10, 0));
    pose.handles["p2"].rotate_rad = 0.1;
    EXPECT_EQ(resolved(pose).holds[0].rotate_rad, 0.1);
    pose.handles["p0"].rotate_rad = 0.2;
    EXPECT_THAT(message_of([&] { resolved(pose); }), HasSubstr("'p0' and 'p2'"));
}

TEST(Binding, AnAffineMapIsForWhoHasUseForIt) {
    const TriangleMesh mesh = reference::grid(20, 20, 100, 100);
    const Rig rig = rig_of_points({{50, 50}});
    const Binding binding = take_hold(mesh, rig, "arap");
    Pose pose;
    pose.handles["p0"].affine = std::array<double, 6>{1, 0, 0, 1, 0, 0};
    EXPECT_THAT(message_of([&] { resolve(binding, mesh, rig, pose, AffineUse::no, "arap"); }), HasSubstr("affine"));
    EXPECT_EQ(message_of([&] { resolve(binding, mesh, rig, pose, AffineUse::yes, "harmonic"); }), "");
}

TEST(Stiffness, MultipliesInsideItsRegions) {
    const TriangleMesh mesh = reference::grid(10, 10, 10, 10);
    EXPECT_EQ(triangle_stiffness(mesh, {}).size(), 0);
    const Eigen::VectorXd s = triangle_stiffness(mesh, {StiffnessRegion{{{0, 0}, {5, 0}, {5, 10}, {0, 10}}, 4},
                                                        StiffnessRegion{{{0, 0}, {10, 0}, {10, 5}, {0, 5}}, 3}});
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        const Point c = (mesh.V.row(mesh.F(t, 0)) + mesh.V.row(mesh.F(t, 1)) + mesh.V.row(mesh.F(t, 2))) / 3;
        EXPECT_EQ(s(t), (c.x() < 5 ? 4.0 : 1.0) * (c.y() < 5 ? 3.0 : 1.0));
    }
}

TEST(Snap, MovesPointsOntoTheSubjectAndNoFarther) {
    const TriangleMesh mesh = reference::grid(10, 10, 100, 100);
    const Rig rig = rig_of_points({{103, 50}, {40, 40}});
    const Rig moved = snapped(rig, mesh, 4);
    const Point& at = std::get<PointHandle>(moved.handles[0].shape).at;
    EXPECT_LT(at.x(), 100);
    EXPECT_LT((at - Point(100, 50)).norm(), 0.05);
    EXPECT_EQ(std::get<PointHandle>(moved.handles[1].shape).at, Point(40, 40));
    EXPECT_EQ(message_of([&] { take_hold(mesh, moved, "arap"); }), "");
    EXPECT_THAT(message_of([&] { snapped(rig, mesh, 2.5); }), AllOf(HasSubstr("'p0'"), HasSubstr("lies 3 px outside")));
}

}  // namespace
}  // namespace puppetwarp
