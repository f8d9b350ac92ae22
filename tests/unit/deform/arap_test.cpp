#include "reference/local_global.h"
#include "reference/test_meshes.h"

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/mesh/distortion.h>
#include <puppetwarp/rig/binding.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace puppetwarp {
namespace {

using reference::nearest_vertex;
using reference::rig_of_points;
using reference::rig_of_vertices;
namespace places = reference::figure_places;

constexpr double degree = std::numbers::pi / 180;

Deformation deformed(const TriangleMesh& mesh, const Rig& rig, const Pose& pose, const MethodOptions& options = {},
                     const Eigen::MatrixX2d* start = nullptr) {
    Progress progress;
    return make_deformer(options, mesh, rig)->deform(pose, start, progress);
}

Rig figure_rig(double size) {
    return rig_of_points({size * places::head, size * places::left_hand, size * places::right_hand,
                          size * places::left_foot, size * places::right_foot, size * places::chest});
}

class ArapTest : public testing::TestWithParam<ArapEnergy> {
protected:
    MethodOptions options() const {
        MethodOptions options;
        options.arap_energy = GetParam();
        return options;
    }
};

TEST_P(ArapTest, EndsWhereLocalGlobalEnds) {
    const TriangleMesh mesh = reference::grid(14, 5, 140, 50, 0.25, 8);
    const std::vector<int> held{nearest_vertex(mesh, {0, 0}), nearest_vertex(mesh, {0, 50}),
                                nearest_vertex(mesh, {140, 0}), nearest_vertex(mesh, {140, 50})};
    Pose pose;
    Eigen::MatrixX2d start = mesh.V;
    for (std::size_t k = 2; k < 4; ++k) {
        const Point p = mesh.V.row(held[k]).transpose();
        const Point to = reference::rigid(p, {140, 25}, 0.6, {-20, 30});
        pose.handles[reference::vertex_id(k)].to = to;
        start.row(held[k]) = to.transpose();
    }
    const Eigen::MatrixX2d expected = reference::local_global(mesh, GetParam(), held, start, 1e-11, 40000);
    MethodOptions tight = options();
    tight.tolerance = 1e-13;
    const Deformation exact = deformed(mesh, rig_of_vertices(held), pose, tight);
    EXPECT_TRUE(exact.converged);
    EXPECT_LT((exact.V - expected).cwiseAbs().maxCoeff(), 1e-4);
    const double least = reference::arap_energy(mesh, GetParam(), expected);
    EXPECT_NEAR(exact.energy, least, 1e-9 * least);

    // The default tolerance speaks the truth about what is left to gain.
    const Deformation usual = deformed(mesh, rig_of_vertices(held), pose, options());
    EXPECT_TRUE(usual.converged);
    EXPECT_LT(usual.energy - least, 1e-8 * least);
}

TEST_P(ArapTest, EnergyNeverRisesAndIsThatOfTheResult) {
    const TriangleMesh mesh = reference::figure(500, 12);
    const Rig rig = figure_rig(500);
    Pose pose;
    pose.handles["p1"].to = 500 * places::left_hand + Point(120, -20);
    pose.handles["p4"].to = 500 * places::right_foot + Point(80, -60);
    const Deformation result = deformed(mesh, rig, pose, options());
    EXPECT_TRUE(result.converged);
    ASSERT_GE(result.energy_history.size(), 2u);
    for (std::size_t k = 1; k < result.energy_history.size(); ++k) {
        EXPECT_LE(result.energy_history[k], result.energy_history[k - 1]);
    }
    EXPECT_NEAR(result.energy, reference::arap_energy(mesh, GetParam(), result.V), 1e-8 * result.energy);
    EXPECT_EQ(result.energy, result.energy_history.back());
    EXPECT_LT(result.max_handle_error_px, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Energies, ArapTest,
                         testing::Values(ArapEnergy::elements, ArapEnergy::spokes, ArapEnergy::spokes_and_rims));

TEST(Arap, FollowsRigidMotionsOfAllHandlesFromRest) {
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
        const TriangleMesh mesh = reference::blob(800, 25, seed);
        const Rig rig = rig_of_points({{400, 400}, {460, 400}, {400, 340}});
        for (const double angle : {0.1, 1.5, 3.0, -2.0}) {
            Pose pose;
            for (const Handle& handle : rig.handles) {
                const Point& at = std::get<PointHandle>(handle.shape).at;
                pose.handles[handle.id].to = reference::rigid(at, {100, 50}, angle, {30, -60});
            }
            const Deformation result = deformed(mesh, rig, pose);
            EXPECT_TRUE(result.converged);
            for (int v = 0; v < mesh.V.rows(); ++v) {
                const Point expected = reference::rigid(mesh.V.row(v).transpose(), {100, 50}, angle, {30, -60});
                ASSERT_LT((result.V.row(v).transpose() - expected).norm(), 1e-9 * 800);
            }
        }
    }
}

TEST(Arap, OnePinMovesAndTurnsTheWholeSubject) {
    const TriangleMesh mesh = reference::figure(400, 12);
    const Rig rig = rig_of_points({400 * places::chest});
    Pose pose;
    pose.handles["p0"].to = 400 * places::chest + Point(25, 10);
    Deformation result = deformed(mesh, rig, pose);
    EXPECT_LT((result.V - (mesh.V.rowwise() + Eigen::RowVector2d(25, 10))).cwiseAbs().maxCoeff(), 1e-9);

    pose.handles["p0"].rotate_rad = 2.5;
    result = deformed(mesh, rig, pose);
    EXPECT_LT(result.energy, 1e-12);
    const Eigen::RowVector2d rest = mesh.V.row(20) - mesh.V.row(0), now = result.V.row(20) - result.V.row(0);
    EXPECT_NEAR(std::atan2(rest.x() * now.y() - rest.y() * now.x(), rest.dot(now)), 2.5, 1e-9);
}

TEST(Arap, FromAStartThatWasDraggedOnePinTranslatesIt) {
    const TriangleMesh mesh = reference::figure(400, 12);
    const Rig rig = rig_of_points({400 * places::chest});
    const Eigen::MatrixX2d start = mesh.V.rowwise() + Eigen::RowVector2d(5, 5);
    Pose pose;
    pose.handles["p0"].to = 400 * places::chest + Point(25, 10);
    const Deformation result = deformed(mesh, rig, pose, {}, &start);
    EXPECT_LT(result.energy, 1e-6);
    EXPECT_LT(result.max_handle_error_px, 1e-9);
}

TEST(Arap, WarmStartEndsWhereTheWholeWayEnds) {
    const TriangleMesh mesh = reference::figure(600, 14);
    const Rig rig = figure_rig(600);
    Pose pose;
    pose.handles["p2"].to = 600 * places::right_hand + Point(30, -50);
    const Deformation before = deformed(mesh, rig, pose);
    pose.handles["p2"].to = 600 * places::right_hand + Point(33, -54);
    const Deformation cold = deformed(mesh, rig, pose);
    const Deformation warm = deformed(mesh, rig, pose, {}, &before.V);
    EXPECT_LT((warm.V - cold.V).cwiseAbs().maxCoeff(), 0.01);
    EXPECT_LE(warm.iterations, cold.iterations);
}

TEST(Arap, SmallMovesFlipNothing) {
    for (const std::uint32_t seed : {1u, 2u, 3u, 4u, 5u}) {
        const TriangleMesh mesh = reference::blob(700, 22, seed);
        const Rig rig = rig_of_points({{350, 350}, {430, 330}, {280, 300}, {330, 440}});
        Pose pose;
        pose.handles["p1"].to = Point(450, 320);
        pose.handles["p3"].to = Point(320, 455);
        const Distortion distortion = measure_distortion(mesh, deformed(mesh, rig, pose).V);
        EXPECT_EQ(distortion.flipped_triangles, 0);
        EXPECT_LT(distortion.max_stretch, 1.6);
    }
}

TEST(Arap, AnArmTurnedFarFromRestDoesNotFold) {
    const double size = 600;
    const TriangleMesh mesh = reference::figure(size, 12);
    Rig rig = figure_rig(size);
    rig.handles.push_back({"shoulder", PointHandle{size * places::right_shoulder, {}}});
    for (const double angle : {60.0, 120.0, 150.0, -60.0}) {
        Pose pose;
        pose.handles["p2"].to =
            reference::rigid(size * places::right_hand, size * places::right_shoulder, angle * degree, {0, 0});
        const Deformation result = deformed(mesh, rig, pose);
        EXPECT_TRUE(result.converged);
        EXPECT_LE(measure_distortion(mesh, result.V).flipped_triangles, 2) << angle;
        EXPECT_LT(result.max_handle_error_px, 1e-9);
    }
}

TEST(Arap, StretchAtAPinDoesNotGrowWithResolution) {
    std::vector<double> stretch;
    for (const int n : {32, 64, 128}) {
        const TriangleMesh mesh = reference::grid(n, n / 4, 1000, 250, 0.2, 7);
        const Rig rig = [] {
            Rig three = rig_of_points({{100, 125}, {500, 125}, {850, 125}});
            for (Handle& handle : three.handles) std::get<PointHandle>(handle.shape).radius_px = 40;
            return three;
        }();
        Pose pose;
        pose.handles["p2"].to = Point(730, 375);
        stretch.push_back(measure_distortion(mesh, deformed(mesh, rig, pose).V).max_stretch);
    }
    EXPECT_NEAR(stretch[2] / stretch[0], 1, 0.1);
    EXPECT_NEAR(stretch[2] / stretch[1], 1, 0.05);
}

TEST(Arap, FixedAnglesAndScalesAreMet) {
    const TriangleMesh mesh = reference::figure(600, 8);
    const Rig rig = figure_rig(600);
    const double disc = default_disc_share * bounding_diagonal(mesh.V);
    for (const double angle : {20.0, -45.0, 100.0, 170.0}) {
        for (const bool scaled : {false, true}) {
            Pose pose;
            pose.handles["p0"].rotate_rad = angle * degree;
            if (scaled) pose.handles["p0"].scale = 1.3;
            const Deformation result = deformed(mesh, rig, pose);
            EXPECT_LT(result.max_handle_error_px, 1e-9);
            // Seen from outside.
            const std::complex<double> turn =
                reference::mean_turn(mesh, result.V, 600 * places::head, disc) * std::polar(1.0, -angle * degree);
            EXPECT_NEAR(std::arg(turn), 0, 1e-9) << angle;
            if (scaled) {
                EXPECT_NEAR(std::abs(turn), 1.3, 1e-9) << angle;
            }
        }
    }
}

TEST(Arap, StiffRegionsKeepTheirShapeBetter) {
    const TriangleMesh mesh = reference::grid(60, 6, 300, 30);
    Rig rig = rig_of_points({{10, 15}, {150, 15}, {290, 15}});
    Pose pose;
    pose.handles["p1"].to = Point(150, 75);
    const auto left_distortion = [&] {
        const Eigen::MatrixX2d V = deformed(mesh, rig, pose).V;
        double sum = 0;
        for (int i = 0; i < 30; ++i) sum += std::abs((V.row(i + 1) - V.row(i)).norm() - 5);
        return sum;
    };
    const double soft = left_distortion();
    rig.stiffness.push_back(StiffnessRegion{{{-1, -1}, {140, -1}, {140, 31}, {-1, 31}}, 50});
    EXPECT_LT(left_distortion(), 0.8 * soft);
}

TEST(Arap, StoppingEarlyIsSaid) {
    const TriangleMesh mesh = reference::figure(400, 14);
    Pose pose;
    pose.handles["p2"].to = 400 * places::right_hand + Point(-100, -100);
    MethodOptions options;
    options.max_iterations = 1;
    const Deformation result = deformed(mesh, figure_rig(400), pose, options);
    EXPECT_FALSE(result.converged);
    EXPECT_LE(result.iterations, 1);
    EXPECT_LT(result.max_handle_error_px, 1e-9);
}

TEST(Arap, AllVerticesHeldIsJustThat) {
    const TriangleMesh mesh = reference::grid(1, 1, 10, 10);
    Pose pose;
    for (int v = 0; v < 4; ++v)
        pose.handles[reference::vertex_id(static_cast<std::size_t>(v))].to = mesh.V.row(v).transpose() * 2;
    const Deformation result = deformed(mesh, rig_of_vertices({0, 1, 2, 3}), pose);
    EXPECT_EQ(result.V, Eigen::MatrixX2d(mesh.V * 2));
    EXPECT_TRUE(result.converged);
}

}  // namespace
}  // namespace puppetwarp
