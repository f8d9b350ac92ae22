#include "reference/test_meshes.h"

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/deform/element_energy.h>
#include <puppetwarp/rig/binding.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace puppetwarp {
namespace {

using namespace reference;

MethodOptions options_of(Method method) {
    MethodOptions options;
    options.method = method;
    options.weights.kind = WeightKind::biharmonic;
    return options;
}

Eigen::MatrixX2d moved(const TriangleMesh& mesh, const Rig& rig, const Pose& pose, Method method) {
    Progress progress;
    return make_deformer(options_of(method), mesh, rig)->deform(pose, nullptr, progress).V;
}

double arap_energy(const TriangleMesh& mesh, const Eigen::MatrixX2d& V) {
    return make_element_arap(mesh, {})->value(complex_positions(V));
}

Rig four_points() {
    return rig_of_points({400 * figure_places::head, 400 * figure_places::left_hand, 400 * figure_places::right_hand,
                          400 * figure_places::belly});
}

TEST(FastSkinning, TurnsPointsByThemselvesWhenAllMovesRigidly) {
    const TriangleMesh mesh = figure(400, 14);
    const Rig rig = four_points();
    for (const double angle : {0.3, 2.5, -3.0}) {
        Pose pose;
        for (const Handle& handle : rig.handles) {
            pose.handles[handle.id].to = rigid(std::get<PointHandle>(handle.shape).at, {100, 50}, angle, {30, -20});
        }
        const Eigen::MatrixX2d V = moved(mesh, rig, pose, Method::fast);
        double off = 0;
        for (Eigen::Index v = 0; v < V.rows(); ++v) {
            off = std::max(
                off, (V.row(v).transpose() - rigid(mesh.V.row(v).transpose(), {100, 50}, angle, {30, -20})).norm());
        }
        EXPECT_LE(off, 1e-6 * bounding_diagonal(mesh.V)) << angle;
    }
}

TEST(FastSkinning, CostsLessThanTheBestAngleThatASearchFinds) {
    const TriangleMesh mesh = figure(400, 14);
    const Rig rig = four_points();
    Pose pose;
    pose.handles["p1"].to = 400 * figure_places::left_hand + Point(60, -40);
    double least = std::numeric_limits<double>::infinity();
    for (double angle = -std::numbers::pi; angle < std::numbers::pi; angle += 0.02) {
        Pose turned = pose;
        turned.handles["p1"].rotate_rad = angle;
        least = std::min(least, arap_energy(mesh, moved(mesh, rig, turned, Method::lbs)));
    }
    EXPECT_LE(arap_energy(mesh, moved(mesh, rig, pose, Method::fast)), least);
}

TEST(FastSkinning, ReportsAnEnergyThatNeverRisesAndConverges) {
    const TriangleMesh mesh = figure(400, 14);
    const Rig rig = four_points();
    Progress progress;
    const auto deformer = make_deformer(options_of(Method::fast), mesh, rig);
    for (int k = 1; k <= 8; ++k) {
        Pose pose;
        pose.handles["p1"].to = 400 * figure_places::left_hand + Point(25 * k, -15 * k);
        pose.handles["p2"].to = 400 * figure_places::right_hand + Point(-10 * k, 30 * k);
        const Deformation result = deformer->deform(pose, nullptr, progress);
        EXPECT_TRUE(result.converged);
        for (std::size_t i = 1; i < result.energy_history.size(); ++i) {
            EXPECT_LE(result.energy_history[i], result.energy_history[i - 1]);
        }
        // Groups share rotations: never less than with one for each triangle.
        EXPECT_GE(result.energy, arap_energy(mesh, result.V) * (1 - 1e-9));
        EXPECT_LE(result.max_handle_error_px, 1e-9);
    }
}

// Where it ends is stationary: no small change of a free map lowers the energy. Written against the blend itself.
TEST(FastSkinning, EndsWhereNoTurnOfAPointGainsAnything) {
    const TriangleMesh mesh = figure(400, 14);
    const Rig rig = four_points();
    Pose pose;
    pose.handles["p1"].to = 400 * figure_places::left_hand + Point(60, -40);
    pose.handles["p1"].scale = 1;  // leaves one unknown: the direction
    for (const char* id : {"p0", "p2", "p3"}) pose.handles[id].rotate_rad = 0;
    const auto energy_at = [&](double angle) {
        Pose turned = pose;
        turned.handles["p1"].rotate_rad = angle;
        Progress progress;
        return make_deformer(options_of(Method::fast), mesh, rig)->deform(turned, nullptr, progress).energy;
    };
    Progress progress;
    const double found = make_deformer(options_of(Method::fast), mesh, rig)->deform(pose, nullptr, progress).energy;
    double least = std::numeric_limits<double>::infinity();
    for (double angle = -1; angle < 1; angle += 1e-3) least = std::min(least, energy_at(angle));
    EXPECT_LE(found, least * (1 + 1e-9));
    EXPECT_GE(found, least * (1 - 1e-4));
}

}  // namespace
}  // namespace puppetwarp
