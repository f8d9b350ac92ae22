#include "field_problem.h"

#include <puppetwarp/deform/falloff.h>
#include <puppetwarp/rig/binding.h>

#include <gtest/gtest.h>

#include <cmath>

namespace puppetwarp {
namespace {

using testing_fields::deformed;
using testing_fields::hold_vertices;
namespace places = reference::figure_places;

Handle region(const std::string& id, double left, double top, double right, double bottom, Falloff falloff) {
    return {id, RegionHandle{{{left, top}, {right, top}, {right, bottom}, {left, bottom}}, falloff}};
}

Eigen::MatrixXd weights_of(const TriangleMesh& mesh, const Rig& rig) {
    return falloff_weights(mesh, rig, take_hold(mesh, rig, "test"), {});
}

const std::vector<Method> field_methods{Method::harmonic, Method::biharmonic, Method::triharmonic,
                                        Method::tetraharmonic, Method::thin_shell};

TEST(Falloff, HarmonicBetweenTwoRingsIsTheLogarithmOfTheRadius) {
    const int rings = 12, sectors = 48;
    const TriangleMesh mesh = reference::annulus(rings, sectors, 1, 10);
    Rig rig;
    rig.handles.push_back(region("inner", -1.001, -1.001, 1.001, 1.001, Falloff::harmonic));
    Pose pose;
    for (int s = 0; s < sectors; ++s) {
        const int v = rings * sectors + s;
        hold_vertices({v}, mesh.V.row(v), rig, pose);
    }
    const Eigen::MatrixXd s = weights_of(mesh, rig);
    ASSERT_EQ(s.cols(), 1);
    for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
        if (mesh.V.row(v).cwiseAbs().maxCoeff() >= 1.001) continue;
        EXPECT_EQ(s(v, 0), 1);
    }
    // The region's square corners blur the inner border; rings beyond obey the mean.
    double outer = 0, inner = 0;
    for (int k = 0; k < sectors; ++k) {
        inner += s(4 * sectors + k, 0) / sectors;
        outer += s(8 * sectors + k, 0) / sectors;
    }
    EXPECT_NEAR(outer / inner, 0.5, 1e-3);
}

// u = sum s_j (T_j p - p), whatever the method: the classic painted regions.
TEST(Falloff, RegionsAloneMoveByTheirWeightsInEveryMethod) {
    const TriangleMesh mesh = reference::figure(500, 10);
    for (const Falloff kind : {Falloff::harmonic, Falloff::geodesic}) {
        Rig rig;
        rig.handles.push_back(region("hand", 0, 40, 50, 110, kind));
        rig.handles.push_back(region("feet", 100, 440, 400, 500, kind));
        Pose pose;
        const Eigen::Rotation2Dd turn(0.6);
        const Eigen::Matrix2d J = turn.toRotationMatrix() * 1.2;
        pose.handles["hand"].affine = {J(0, 0), J(1, 0), J(0, 1), J(1, 1), 12, -30};
        const Eigen::MatrixXd s = weights_of(mesh, rig);
        EXPECT_LT((s.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-12);
        EXPECT_GT(s.minCoeff(), -1e-12);
        for (const Method method : field_methods) {
            const Eigen::MatrixX2d V = deformed(method, mesh, rig, pose).V;
            for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
                const Point p = mesh.V.row(v).transpose();
                const Point expected = p + s(v, 0) * (J * p + Point(12, -30) - p);
                ASSERT_LT((V.row(v).transpose() - expected).norm(), 1e-11);
            }
        }
    }
}

TEST(Falloff, GeodesicOnAStripIsTheCurveBetweenTheTwoDistances) {
    const TriangleMesh mesh = reference::grid(50, 4, 100, 8);
    Rig rig;
    rig.handles.push_back(region("left", -1, -1, 10.1, 9, Falloff::geodesic));
    rig.handles.push_back(region("right", 79.9, -1, 101, 9, Falloff::none));
    const Eigen::MatrixXd s = weights_of(mesh, rig);
    for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
        const double a = std::max(0.0, mesh.V(v, 0) - 10), b = std::max(0.0, 80 - mesh.V(v, 0));
        EXPECT_NEAR(s(v, 0), b * b / (a * a + b * b), 1e-12);
    }
}

// Hands that nearly touch are far apart along the body.
TEST(Falloff, GeodesicDoesNotLeakAcrossGaps) {
    // A horseshoe: two arms 2 px apart, joined far away.
    const auto inside = [](double x, double y) {
        return x > 2 && x < 98 && y > 2 && y < 98 && (std::abs(y - 50) > 2 || x > 85);
    };
    const TriangleMesh mesh = reference::shape(inside, 100, 3);
    Rig rig;
    rig.handles.push_back(region("upper", 0, 0, 15, 50, Falloff::geodesic));
    rig.handles.push_back(region("end", 85, 0, 100, 100, Falloff::none));
    const Eigen::MatrixXd s = weights_of(mesh, rig);
    EXPECT_GT(s(reference::nearest_vertex(mesh, {20, 45}), 0), 0.9);
    EXPECT_LT(s(reference::nearest_vertex(mesh, {20, 55}), 0), 0.5);
}

// What remains after the falloff is the method's own field, 0 in the regions.
TEST(Falloff, OtherHandlesGetWhatRemains) {
    const TriangleMesh mesh = reference::figure(500, 10);
    Rig rig;
    rig.handles.push_back(region("torso", 220, 230, 280, 330, Falloff::harmonic));
    rig.handles.push_back({"hand", PointHandle{500 * places::left_hand, {}}});
    rig.handles.push_back({"foot", PointHandle{500 * places::right_foot, {}}});
    Pose pose;
    pose.handles["torso"].affine = {0.95, 0.3, -0.3, 0.95, 105, -80};
    pose.handles["hand"].to = 500 * places::left_hand + Point(10, 60);
    pose.handles["foot"].rotate_rad = 0.4;
    for (const Method method : field_methods) {
        const Deformation all = deformed(method, mesh, rig, pose);
        EXPECT_LT(all.max_handle_error_px, 1e-9);
        // By hand: the falloff part, and the field of a rig whose region is held still.
        Pose torso_only;
        torso_only.handles["torso"] = pose.handles["torso"];
        const Binding binding = take_hold(mesh, rig, "test");
        const AffineMap map = resolve(binding, mesh, rig, torso_only, AffineUse::yes, "test").maps[0];
        const Eigen::VectorXcd rest = complex_positions(mesh.V);
        const Eigen::VectorXd s = weights_of(mesh, rig).col(0);
        Eigen::VectorXcd u(rest.size());
        for (Eigen::Index v = 0; v < u.size(); ++v) u(v) = s(v) * (map(rest(v)) - rest(v));
        const Eigen::VectorXcd remains = complex_positions(all.V) - rest - u;
        for (const HeldVertex& held : binding.vertices) EXPECT_LT(std::abs(remains(held.vertex)), 1e-11);
        Rig still = rig;
        std::get<RegionHandle>(still.handles[0].shape).falloff = Falloff::none;
        Pose rest_pose;
        const std::complex<double> hand_left = row_value(binding.holds[0].mean, u);
        rest_pose.handles["hand"].to = *pose.handles["hand"].to - Point(hand_left.real(), hand_left.imag());
        // The foot's turn less the falloff's: as an affine map would fix the shear too, compare by its angle and scale.
        const std::complex<double> turn = std::polar(1.0, 0.4) - row_value(binding.holds[1].turn, u);
        const std::complex<double> foot_left = row_value(binding.holds[1].mean, u);
        rest_pose.handles["foot"].to = Point(500 * places::right_foot) - Point(foot_left.real(), foot_left.imag());
        rest_pose.handles["foot"].rotate_rad = std::arg(turn);
        rest_pose.handles["foot"].scale = std::abs(turn);
        const Eigen::VectorXcd field = complex_positions(deformed(method, mesh, still, rest_pose).V) - rest;
        EXPECT_LT((field - remains).cwiseAbs().maxCoeff(), 1e-9);
    }
}

// A new point is a new place where the weights are 0.
TEST(Falloff, ARigThatGainsAPointIsTheSameAsAnew) {
    const TriangleMesh mesh = reference::figure(500, 12);
    Rig rig;
    rig.handles.push_back(region("torso", 220, 230, 280, 330, Falloff::geodesic));
    rig.handles.push_back(region("feet", 100, 440, 400, 500, Falloff::harmonic));
    const auto first = testing_fields::made(Method::thin_shell, mesh, rig);
    rig.handles.insert(rig.handles.begin(), {"hand", PointHandle{500 * places::left_hand, {}}});
    Pose pose;
    pose.handles["torso"].affine = {0.95, 0.3, -0.3, 0.95, 105, -80};
    pose.handles["hand"].rotate_rad = 0.3;
    const auto next = first->with_rig(rig);
    ASSERT_TRUE(next);
    Progress progress;
    EXPECT_EQ(next->deform(pose, nullptr, progress).V, deformed(Method::thin_shell, mesh, rig, pose).V);
}

TEST(Falloff, ReachesOnlyItsOwnComponentAndFillsItWhenAlone) {
    const TriangleMesh mesh =
        reference::joined(reference::grid(6, 6, 60, 60, 0.2), reference::grid(4, 4, 40, 40), {90, 0});
    for (const Falloff kind : {Falloff::harmonic, Falloff::geodesic}) {
        Rig rig;
        rig.handles.push_back(region("r", -1, -1, 25, 25, kind));
        const Eigen::MatrixXd s = weights_of(mesh, rig);
        for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
            EXPECT_NEAR(s(v, 0), mesh.V(v, 0) < 80 ? 1 : 0, 1e-12);
        }
    }
}

}  // namespace
}  // namespace puppetwarp
