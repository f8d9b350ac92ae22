#include "reference/test_meshes.h"

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/mesh/operators.h>
#include <puppetwarp/rig/binding.h>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <cmath>

namespace puppetwarp {
namespace {

using reference::nearest_vertex;
using reference::rig_of_points;
using reference::rig_of_vertices;

Deformation deformed(Method method, const TriangleMesh& mesh, const Rig& rig, const Pose& pose) {
    MethodOptions options;
    options.method = method;
    Progress progress;
    return make_deformer(options, mesh, rig)->deform(pose, nullptr, progress);
}

TEST(Harmonic, BetweenTwoRingsIsTheLogarithmOfTheRadius) {
    const int rings = 24, sectors = 48;
    const double inner = 10, outer = 100;
    const TriangleMesh mesh = reference::annulus(rings, sectors, inner, outer);
    std::vector<int> held;
    Pose pose;
    for (int s = 0; s < sectors; ++s) held.push_back(s);
    for (int s = 0; s < sectors; ++s) held.push_back(rings * sectors + s);
    for (int s = 0; s < sectors; ++s) {
        pose.handles[reference::vertex_id(static_cast<std::size_t>(sectors + s))].to =
            mesh.V.row(rings * sectors + s).transpose() + Point(7, 3);
    }
    const Deformation result = deformed(Method::harmonic, mesh, rig_of_vertices(held), pose);
    for (int v = 0; v < mesh.V.rows(); ++v) {
        const double share = std::log(mesh.V.row(v).norm() / inner) / std::log(outer / inner);
        EXPECT_LT((result.V.row(v) - mesh.V.row(v) - share * Eigen::RowVector2d(7, 3)).norm(), 2e-3 * 7);
    }
    // Of a function with boundary values 0 and 1: 2 pi / log(outer / inner).
    EXPECT_NEAR(result.energy, 58 * 2 * M_PI / std::log(10.0), 0.01 * result.energy);
}

TEST(Harmonic, AnAffineBorderMakesAnAffineInside) {
    const TriangleMesh mesh = reference::grid(12, 9, 120, 90, 0.25, 3);
    Eigen::Matrix2d J;
    J << 1.3, 0.4, -0.2, 0.8;
    std::vector<int> held;
    Pose pose;
    for (int v = 0; v < mesh.V.rows(); ++v) {
        const double x = mesh.V(v, 0), y = mesh.V(v, 1);
        if (x > 0 && x < 120 && y > 0 && y < 90) continue;
        pose.handles[reference::vertex_id(held.size())].to = J * mesh.V.row(v).transpose() + Point(5, 5);
        held.push_back(v);
    }
    const Deformation result = deformed(Method::harmonic, mesh, rig_of_vertices(held), pose);
    const Eigen::MatrixX2d expected = (mesh.V * J.transpose()).rowwise() + Eigen::RowVector2d(5, 5);
    EXPECT_LT((result.V - expected).cwiseAbs().maxCoeff(), 1e-10);
}

// The minimiser of a quadratic energy with constraints, by one dense saddle system.
Eigen::MatrixX2d dense_minimiser(const Eigen::MatrixXd& H, const Eigen::MatrixXd& C, const Eigen::MatrixXd& d) {
    const Eigen::Index n = H.rows(), m = C.rows();
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n + m, n + m);
    K << H, C.transpose(), C, Eigen::MatrixXd::Zero(m, m);
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(n + m, 2);
    b.bottomRows(m) = d;
    return K.fullPivLu().solve(b).topRows(n);
}

class PolyharmonicTest : public testing::TestWithParam<Method> {};

TEST_P(PolyharmonicTest, IsTheMinimiserADenseSystemFinds) {
    const TriangleMesh mesh = reference::grid(11, 8, 11, 8, 0.25, 6);
    const std::vector<int> held{0, 40, 77, 105};
    Pose pose;
    pose.handles["v1"].to = mesh.V.row(40).transpose() + Point(1, 0.5);
    pose.handles["v3"].to = mesh.V.row(105).transpose() + Point(-0.5, 2);
    const Deformation result = deformed(GetParam(), mesh, rig_of_vertices(held), pose);

    Eigen::MatrixXd H(cotangent_stiffness(mesh));
    if (GetParam() == Method::biharmonic) H = H * lumped_mass(mesh).cwiseInverse().asDiagonal() * H;
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(4, mesh.V.rows()), d = Eigen::MatrixXd::Zero(4, 2);
    for (Eigen::Index k = 0; k < 4; ++k) C(k, held[static_cast<std::size_t>(k)]) = 1;
    d.row(1) << 1, 0.5;
    d.row(3) << -0.5, 2;
    const Eigen::MatrixX2d u = dense_minimiser(H, C, d);
    EXPECT_LT((result.V - mesh.V - u).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_NEAR(result.energy, (u.transpose() * H * u).trace(), 1e-9 * result.energy);
}

TEST_P(PolyharmonicTest, MeetsAnglesOfItsDiscs) {
    const TriangleMesh mesh = reference::figure(400, 8);
    namespace places = reference::figure_places;
    const Rig rig = rig_of_points({400 * places::head, 400 * places::right_hand, 400 * places::left_foot});
    Pose pose;
    pose.handles["p1"].rotate_rad = 0.5;
    pose.handles["p0"].rotate_rad = -0.2;
    pose.handles["p0"].scale = 1.4;
    pose.handles["p2"].to = 400 * places::left_foot + Point(10, 0);
    const Deformation result = deformed(GetParam(), mesh, rig, pose);
    EXPECT_LT(result.max_handle_error_px, 1e-9);
    // Seen from outside.
    const double disc = default_disc_share * bounding_diagonal(mesh.V);
    const std::complex<double> hand = reference::mean_turn(mesh, result.V, 400 * places::right_hand, disc);
    EXPECT_LT(std::abs(hand - std::polar(1.0, 0.5)), 1e-9);
    const std::complex<double> head = reference::mean_turn(mesh, result.V, 400 * places::head, disc);
    EXPECT_LT(std::abs(head - std::polar(1.4, -0.2)), 1e-9);
}

TEST_P(PolyharmonicTest, ManyVerticesAndFineMeshesStayExactUnderTranslation) {
    const TriangleMesh mesh = reference::figure(1000, 7);
    const Rig rig = rig_of_vertices({0, 500, 1000, 2000, 3000, 4000});
    Pose pose;
    for (std::size_t k = 0; k < rig.handles.size(); ++k) {
        const int v = std::get<VertexHandle>(rig.handles[k].shape).index;
        pose.handles[rig.handles[k].id].to = mesh.V.row(v).transpose() + Point(123, -77);
    }
    const Deformation result = deformed(GetParam(), mesh, rig, pose);
    const Eigen::MatrixX2d expected = mesh.V.rowwise() + Eigen::RowVector2d(123, -77);
    EXPECT_LT((result.V - expected).cwiseAbs().maxCoeff(), 1e-12 * 1400);
}

INSTANTIATE_TEST_SUITE_P(Methods, PolyharmonicTest, testing::Values(Method::harmonic, Method::biharmonic));

TEST(Harmonic, StiffRegionsMoveLess) {
    const TriangleMesh mesh = reference::grid(40, 4, 100, 10);
    Rig rig = rig_of_vertices({nearest_vertex(mesh, {0, 5}), nearest_vertex(mesh, {100, 5})});
    Pose pose;
    pose.handles["v1"].to = Point(120, 5);
    const auto stretch_of_left_half = [&] {
        const Deformation result = deformed(Method::harmonic, mesh, rig, pose);
        const int a = nearest_vertex(mesh, {10, 5}), b = nearest_vertex(mesh, {40, 5});
        return (result.V(b, 0) - result.V(a, 0)) / 30 - 1;
    };
    const double soft = stretch_of_left_half();
    rig.stiffness.push_back(StiffnessRegion{{{-1, -1}, {50, -1}, {50, 11}, {-1, 11}}, 20});
    const double stiff = stretch_of_left_half();
    EXPECT_GT(soft, 0.1);
    EXPECT_GT(stiff, 0);
    EXPECT_LT(stiff, 0.15 * soft);
}

}  // namespace
}  // namespace puppetwarp
