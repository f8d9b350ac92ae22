#include "field_problem.h"

#include <puppetwarp/base/errors.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

namespace puppetwarp {
namespace {

using reference::rig_of_points;
using testing_fields::deformed;
using testing_fields::dense_answer;
using testing_fields::hold_vertices;

MethodOptions shell(double stretching, double bending) {
    MethodOptions options;
    options.method = Method::thin_shell;
    options.stretching = stretching;
    options.bending = bending;
    return options;
}

Pose some_pose(Rig& rig, const TriangleMesh& mesh) {
    for (Handle& handle : rig.handles) std::get<PointHandle>(handle.shape).radius_px = 15;
    Pose pose;
    pose.handles["p0"].to = Point(25, 10);
    pose.handles["p1"].rotate_rad = 0.7;
    rig.handles.push_back({"r", RegionHandle{{{55, -5}, {75, -5}, {75, 28}, {55, 28}}, Falloff::none}});
    pose.handles["r"].affine = {0.9, -0.5, 0.4, 1.1, 4, 40};
    hold_vertices({3}, mesh.V.row(3) + Eigen::RowVector2d(2, 2), rig, pose);
    return pose;
}

TEST(ThinShell, IsTheMinimiserADenseSystemFinds) {
    const TriangleMesh mesh = reference::grid(10, 6, 100, 60, 0.28, 6);
    for (const auto& [held, stiff] : {std::pair(false, false), std::pair(false, true), std::pair(true, true)}) {
        Rig rig = rig_of_points({{12, 14}, {83, 20}, {48, 47}});
        Pose pose;
        pose.handles["p0"].to = Point(25, 10);
        if (held) pose = some_pose(rig, mesh);
        if (stiff) rig.stiffness.push_back(StiffnessRegion{{{-1, 30}, {60, 30}, {60, 61}, {-1, 61}}, 7});
        Eigen::VectorXd stiffness = Eigen::VectorXd::Ones(mesh.F.rows());
        for (Eigen::Index t = 0; stiff && t < mesh.F.rows(); ++t) {
            const Point centroid =
                (mesh.V.row(mesh.F(t, 0)) + mesh.V.row(mesh.F(t, 1)) + mesh.V.row(mesh.F(t, 2))).transpose() / 3;
            if (centroid.x() < 60 && centroid.y() > 30) stiffness(t) = 7;
        }
        const double size = bounding_diagonal(mesh.V);
        const Eigen::MatrixX2d expected = dense_answer({2, 0.02 * size * size, 1.5, stiffness}, mesh, rig, pose);
        const Deformation result = deformed(shell(1.5, 0.02), mesh, rig, pose);
        EXPECT_LT((result.V - expected).cwiseAbs().maxCoeff(), 1e-9 * size);
    }
}

TEST(ThinShell, WithoutBendingIsHarmonicAndWithoutStretchingBiharmonic) {
    const TriangleMesh mesh = reference::grid(20, 12, 100, 60, 0.28, 6);
    Rig rig = rig_of_points({{12, 14}, {83, 20}, {48, 47}});
    const Pose pose = some_pose(rig, mesh);
    rig.stiffness.push_back(StiffnessRegion{{{-1, 30}, {60, 30}, {60, 61}, {-1, 61}}, 7});
    const Eigen::MatrixX2d harmonic = deformed(Method::harmonic, mesh, rig, pose).V;
    const Eigen::MatrixX2d biharmonic = deformed(Method::biharmonic, mesh, rig, pose).V;
    EXPECT_LT((deformed(shell(3, 0), mesh, rig, pose).V - harmonic).cwiseAbs().maxCoeff(), 1e-10);
    EXPECT_LT((deformed(shell(0, 0.3), mesh, rig, pose).V - biharmonic).cwiseAbs().maxCoeff(), 1e-10);
    EXPECT_GT((biharmonic - harmonic).cwiseAbs().maxCoeff(), 0.1);
}

// A strip clamped at both ends, one raised: -k_s u'' + k_b u'''' = 0 with u' = 0 at the ends, since every row of L is
// in use, and no slope across the free sides either.
double strip_error(double stretching, double bending, int nx) {
    const double length = 100;
    const TriangleMesh mesh = reference::grid(nx, std::max(2, nx / 10), length, 10);
    Rig rig;
    Pose pose;
    for (int v = 0; v < mesh.V.rows(); ++v) {
        if (mesh.V(v, 0) <= 0) hold_vertices({v}, mesh.V.row(v), rig, pose);
        if (mesh.V(v, 0) >= length) hold_vertices({v}, mesh.V.row(v) + Eigen::RowVector2d(0, 1), rig, pose);
    }
    const Eigen::MatrixX2d V = deformed(shell(stretching, bending), mesh, rig, pose).V;
    const double k = std::sqrt(stretching / (bending * mesh.V.row(mesh.V.rows() - 1).squaredNorm()));
    // About the middle, s = x - length / 2: u = 1/2 + a s + b sinh(k s), or the cubic without stretching.
    const double h = length / 2;
    const auto profile = [&](double x) {
        const double s = x - h;
        if (stretching == 0) return 0.5 + 0.75 * s / h - 0.25 * std::pow(s / h, 3);
        const double b = -0.5 / (k * h * std::cosh(k * h) - std::sinh(k * h));
        return 0.5 - b * k * std::cosh(k * h) * s + b * std::sinh(k * s);
    };
    double error = 0;
    for (int v = 0; v < mesh.V.rows(); ++v) {
        error = std::max(error, std::abs(V(v, 1) - mesh.V(v, 1) - profile(mesh.V(v, 0))));
    }
    return error;
}

TEST(ThinShell, ConvergesToTheClampedBeam) {
    for (const auto& [stretching, bending] : {std::pair(1.0, 0.01), std::pair(1.0, 0.001), std::pair(0.0, 1.0)}) {
        const double coarse = strip_error(stretching, bending, 40);
        const double fine = strip_error(stretching, bending, 80);
        const double finer = strip_error(stretching, bending, 160);
        EXPECT_LT(fine, coarse / 3.5);
        EXPECT_LT(finer, fine / 3.5);
        EXPECT_LT(finer, 2e-4);
    }
}

TEST(ThinShell, ChecksItsWeights) {
    const TriangleMesh mesh = reference::grid(4, 4, 10, 10);
    const Rig rig = rig_of_points({{5, 5}});
    const auto refused = [&](double stretching, double bending) {
        EXPECT_THROW(make_deformer(shell(stretching, bending), mesh, rig), InvalidInput) << stretching << bending;
    };
    refused(0, 0);
    refused(-1, 1);
    refused(1, -1);
    refused(std::numeric_limits<double>::quiet_NaN(), 1);
    refused(1, std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace puppetwarp
