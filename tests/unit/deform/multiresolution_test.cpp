#include "reference/test_meshes.h"

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/deform/smooth_base.h>
#include <puppetwarp/rig/binding.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace puppetwarp {
namespace {

namespace places = reference::figure_places;

Deformation deformed(Method method, const TriangleMesh& mesh, const Rig& rig, const Pose& pose) {
    MethodOptions options;
    options.method = method;
    Progress progress;
    return make_deformer(options, mesh, rig)->deform(pose, nullptr, progress);
}

// Of e^(i s / R) the least of |b - p|^2 + l^4 |b''|^2 is p / (1 + (l / R)^4); inside, detail is harmonic.
TEST(SmoothBase, OfARingIsKnown) {
    const double inner = 40, outer = 100, length = 12;
    const TriangleMesh mesh = reference::annulus(16, 240, inner, outer);
    const Eigen::VectorXcd detail = detail_over_smooth_base(mesh, length);
    const auto taken = [&](double radius) { return 1 - 1 / (1 + std::pow(length / radius, 4)); };
    // Harmonic and turning once with the angle: a r + b / r.
    Eigen::Matrix2d A;
    A << inner, 1 / inner, outer, 1 / outer;
    const Eigen::Vector2d ab = A.inverse() * Eigen::Vector2d(inner * taken(inner), outer * taken(outer));
    for (int v = 0; v < mesh.V.rows(); ++v) {
        const std::complex<double> p(mesh.V(v, 0), mesh.V(v, 1));
        const double r = std::abs(p);
        EXPECT_LT(std::abs(detail(v) - p / r * (ab(0) * r + ab(1) / r)), 0.01 * inner * taken(inner));
    }
}

TEST(SmoothBase, KeepsWhatIsStraightAndNearlyAllOfSmallHoles) {
    const TriangleMesh strip = reference::grid(80, 8, 800, 80);
    const Eigen::VectorXcd detail = detail_over_smooth_base(strip, 10);
    // What the corners lose fades along the sides within a few lengths.
    for (int i = 15; i <= 65; ++i) EXPECT_LT(std::abs(detail(i)), 1e-3);
    const TriangleMesh ring = reference::annulus(16, 96, 5, 100);
    const Eigen::VectorXcd of_ring = detail_over_smooth_base(ring, 30);
    for (int s = 0; s < 96; ++s) EXPECT_LT(std::abs(of_ring(s)), 0.02 * 5);
}

// A wave of length 2 pi / k along a straight side loses the share (k l)^4 / (1 + (k l)^4) of its height.
TEST(SmoothBase, TakesShortWavesAndLeavesLongOnes) {
    const double width = 600, length = 12;
    for (const double waves : {4.0, 20.0}) {
        const double k = 2 * std::numbers::pi * waves / width;
        TriangleMesh mesh = reference::grid(400, 20, width, 60);
        for (int v = 0; v < mesh.V.rows(); ++v) {
            mesh.V(v, 1) += mesh.V(v, 1) / 60 * 0.4 * std::cos(k * mesh.V(v, 0));
        }
        const Eigen::VectorXcd detail = detail_over_smooth_base(mesh, length);
        const double share = std::pow(k * length, 4) / (1 + std::pow(k * length, 4));
        for (int i = 150; i <= 250; ++i) {
            const double x = width * i / 400;
            EXPECT_NEAR(detail(20 * 401 + i).imag(), share * 0.4 * std::cos(k * x), 0.01 * 0.4);
        }
    }
}

TEST(Multiresolution, RestIsRestAndRigidMotionsAreExact) {
    for (const double edge : {22.0, 8.0}) {
        const TriangleMesh mesh = reference::figure(500, edge);
        const Rig rig =
            reference::rig_of_points({500 * places::head, 500 * places::left_hand, 500 * places::right_foot});
        EXPECT_LT((deformed(Method::multiresolution, mesh, rig, Pose()).V - mesh.V).cwiseAbs().maxCoeff(), 1e-11);
        Pose pose;
        for (const Handle& handle : rig.handles) {
            pose.handles[handle.id].to =
                reference::rigid(std::get<PointHandle>(handle.shape).at, {100, 300}, 2.9, {40, 50});
        }
        const Deformation result = deformed(Method::multiresolution, mesh, rig, pose);
        for (int v = 0; v < mesh.V.rows(); ++v) {
            const Point expected = reference::rigid(mesh.V.row(v).transpose(), {100, 300}, 2.9, {40, 50});
            EXPECT_LT((result.V.row(v).transpose() - expected).norm(), 1e-9 * 500);
        }
    }
}

// Kobbelt et al. 1998: bumps of a strip that is bent stand on it as before, where a displacement field shears them.
TEST(Multiresolution, DetailTurnsWithTheBase) {
    const double width = 600;
    TriangleMesh mesh = reference::grid(240, 24, width, 60);
    const double k = 2 * std::numbers::pi / 25;
    for (int v = 0; v < mesh.V.rows(); ++v) {
        mesh.V(v, 1) += mesh.V(v, 1) / 60 * 4 * std::cos(k * mesh.V(v, 0));
    }
    Rig rig;
    rig.handles.push_back({"a", RegionHandle{{{-1, -9}, {3, -9}, {3, 99}, {-1, 99}}}});
    rig.handles.push_back({"b", RegionHandle{{{597, -9}, {601, -9}, {601, 99}, {597, 99}}}});
    Pose pose;
    // About the right end of what is free, so that the strip is bent by 60 degrees between.
    const double angle = std::numbers::pi / 3;
    const Point origin = reference::rigid({0, 0}, {600, 30}, angle, {-90, 280});
    pose.handles["b"].affine = {
        {std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle), origin.x(), origin.y()}};
    // How far a bump's top leans over its feet: 0 where it stands upright.
    const auto lean = [&](Method method) {
        const Eigen::MatrixX2d V = deformed(method, mesh, rig, pose).V;
        double largest = 0;
        for (int bump = 9; bump <= 15; ++bump) {
            const int top = 24 * 241 + bump * 10, left = top - 5, right = top + 5;
            const Eigen::RowVector2d feet = V.row(right) - V.row(left);
            const Eigen::RowVector2d up = V.row(top) - (V.row(left) + V.row(right)) / 2;
            largest = std::max(largest, std::abs(feet.normalized().dot(up.normalized())));
        }
        return largest;
    };
    EXPECT_GT(lean(Method::biharmonic), 0.5);
    EXPECT_LT(lean(Method::multiresolution), 0.1);
}

TEST(Multiresolution, MeetsAllKindsOfHandles) {
    const double size = 500;
    const TriangleMesh mesh = reference::figure(size, 9);
    Rig rig = reference::rig_of_points({size * places::head, size * places::right_foot});
    rig.handles.push_back({"arm", BoneHandle{size * Point(0.42, 0.42), size * Point(0.2, 0.3), {}}});
    rig.handles.push_back(
        {"belly", RegionHandle{{size * Point(0.4, 0.6), size * Point(0.62, 0.6), size * Point(0.5, 0.75)}}});
    Pose pose;
    pose.handles["p0"].to = size * (places::head + Point(0.05, 0.02));
    pose.handles["p0"].rotate_rad = 0.6;
    pose.handles["p1"].to = size * (places::right_foot + Point(0.1, -0.15));
    pose.handles["arm"].rotate_rad = -0.4;
    pose.handles["belly"].rotate_rad = 0.3;
    const Deformation result = deformed(Method::multiresolution, mesh, rig, pose);
    EXPECT_TRUE(result.converged);
    EXPECT_LT(result.max_handle_error_px, 1e-9);
    const Binding binding = take_hold(mesh, rig, "test");
    const Targets targets = resolve(binding, mesh, rig, pose, AffineUse::no, "test");
    for (std::size_t i = 0; i < binding.vertices.size(); ++i) {
        const Eigen::RowVector2d at = result.V.row(binding.vertices[i].vertex);
        EXPECT_LT(std::abs(std::complex<double>(at.x(), at.y()) - targets.vertices(static_cast<Eigen::Index>(i))),
                  1e-9);
    }
}

}  // namespace
}  // namespace puppetwarp
