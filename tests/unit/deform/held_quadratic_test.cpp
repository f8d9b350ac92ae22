// Parts that the differential methods share: goals of turns, mixing, and rigs that are hard on constraints.
#include "reference/test_meshes.h"

#include <puppetwarp/deform/anderson.h>
#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/deform/turn_goals.h>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <cmath>

namespace puppetwarp {
namespace {

using Complex = std::complex<double>;

Eigen::MatrixXcd some_response(Eigen::Index size) {
    Eigen::MatrixXcd A(size, size);
    for (Eigen::Index i = 0; i < size; ++i) {
        for (Eigen::Index j = 0; j < size; ++j) {
            A(i, j) = Complex(std::sin(3.0 * static_cast<double>(i) + 1.7 * static_cast<double>(j)),
                              std::cos(2.0 * static_cast<double>(i * j) + 0.3));
        }
    }
    return A * A.adjoint() + Eigen::MatrixXcd::Identity(size, size);
}

TEST(TurnGoals, AreMetWithTheLeastEnergy) {
    const Eigen::MatrixXcd S = some_response(4);
    Eigen::VectorXcd f0(4);
    f0 << Complex(1, 0.2), Complex(0.8, -0.3), Complex(1.1, 0.1), Complex(0, 0.4);
    const std::vector<RowGoal> goals{{0, RowGoal::Kind::value, Complex(0.5, 1)},
                                     {1, RowGoal::Kind::direction, std::polar(1.0, -0.1)},
                                     {2, RowGoal::Kind::length, Complex(1.6)}};
    const Eigen::MatrixXcd none(4, 0);
    const auto steps = meet(goals, f0, S, none);
    const Eigen::VectorXcd f = f0 + S * steps.multipliers;
    for (const RowGoal& goal : goals) EXPECT_LT(distance_to(goal, f(goal.row)), 1e-12);
    EXPECT_EQ(steps.multipliers(3), 0.0);
    // Multipliers push only along what is fixed: across a direction, along a length.
    EXPECT_NEAR((std::conj(goals[1].value) * steps.multipliers(1)).real(), 0, 1e-12);
    EXPECT_NEAR((std::conj(f(2)) * steps.multipliers(2)).imag(), 0, 1e-6);
    EXPECT_GT((std::conj(goals[1].value) * f(1)).real(), 0.1);
}

TEST(TurnGoals, ADirectionIsNotMetFromBehind) {
    const Eigen::VectorXcd f0 = Eigen::VectorXcd::Constant(1, 1);
    const Eigen::MatrixXcd S = Eigen::MatrixXcd::Identity(1, 1), none(1, 0);
    for (const double angle : {0.5, 1.56, 2.0, 3.1, -2.5}) {
        const auto steps = meet({{0, RowGoal::Kind::direction, std::polar(1.0, angle)}}, f0, S, none);
        EXPECT_NEAR(std::arg(f0(0) + steps.multipliers(0)), angle, 1e-12);
        if (std::abs(angle) > 1.5) {
            EXPECT_NEAR(std::abs(f0(0) + steps.multipliers(0)), 1, 1e-12);
        }
    }
}

TEST(TurnGoals, LengthsAreMetHoweverTheyPull) {
    const Eigen::MatrixXcd S = some_response(3), none(3, 0);
    Eigen::VectorXcd f0(3);
    f0 << Complex(1, 0), Complex(0.2, -1), Complex(-0.5, 0.3);
    for (const double length : {0.05, 0.5, 1.0, 4.0}) {
        std::vector<RowGoal> goals;
        goals.reserve(3);
        for (int row = 0; row < 3; ++row) goals.push_back({row, RowGoal::Kind::length, Complex(length)});
        const Eigen::VectorXcd f = f0 + S * meet(goals, f0, S, none).multipliers;
        for (const RowGoal& goal : goals) EXPECT_LT(distance_to(goal, f(goal.row)), 1e-12 * length);
    }
}

TEST(TurnGoals, WhatCostsNothingGoesFirst) {
    const Eigen::VectorXcd f0 = Eigen::VectorXcd::Constant(1, Complex(0.6, 0.8));
    const auto steps = meet({{0, RowGoal::Kind::length, Complex(3)}}, f0, Eigen::MatrixXcd::Identity(1, 1),
                            Eigen::MatrixXcd::Constant(1, 1, Complex(0, 0.01)));
    EXPECT_LT(std::abs(steps.multipliers(0)), 1e-12);
    EXPECT_LT(std::abs(f0(0) + Complex(0, 0.01) * steps.modes(0) - Complex(1.8, 2.4)), 1e-12);
}

// A linear iteration on n numbers is solved by n + 1 mixed steps; linear equations that all values meet stay met.
TEST(AndersonMixing, SolvesALinearIteration) {
    const Eigen::Index n = 5;
    const Eigen::MatrixXcd G = 0.9 * some_response(n) / some_response(n).norm();
    const Eigen::VectorXcd b = Eigen::VectorXcd::LinSpaced(n, Complex(1, 2), Complex(-3, 1));
    const Eigen::VectorXcd solution = (Eigen::MatrixXcd::Identity(n, n) - G).partialPivLu().solve(b);
    AndersonMixing mixing;
    Eigen::VectorXcd x = Eigen::VectorXcd::Zero(n);
    for (int i = 0; i < 12; ++i) x = mixing.next(x, G * x + b);
    EXPECT_LT((x - solution).norm(), 1e-8 * solution.norm());

    AndersonMixing kept;
    x = b / b.sum();
    for (int i = 0; i < 4; ++i) {
        Eigen::VectorXcd g = G * x;
        g.array() += (1.0 - g.sum()) / static_cast<double>(n);
        x = kept.next(x, g);
        EXPECT_LT(std::abs(x.sum() - 1.0), 1e-10);
    }
}

class HardRigs : public testing::TestWithParam<Method> {
protected:
    Deformation deformed(const TriangleMesh& mesh, const Rig& rig, const Pose& pose) const {
        MethodOptions options;
        options.method = GetParam();
        Progress progress;
        return make_deformer(options, mesh, rig)->deform(pose, nullptr, progress);
    }
};

TEST_P(HardRigs, EachComponentFollowsItsOwnHandles) {
    const TriangleMesh a = reference::blob(200, 18, 1);
    const TriangleMesh mesh = reference::joined(a, a, Point(400, 0));
    Rig rig = reference::rig_of_points({{100, 100}, {80, 110}, {500, 100}});
    Pose pose;
    pose.handles["p2"].to = Point(520, 130);
    const Deformation result = deformed(mesh, rig, pose);
    const Eigen::Index half = a.V.rows();
    EXPECT_LT((result.V.topRows(half) - a.V).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((result.V.bottomRows(half) - (a.V.rowwise() + Eigen::RowVector2d(420, 30))).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_P(HardRigs, HeldVerticesAloneAreEnough) {
    const TriangleMesh mesh = reference::blob(200, 16, 5);
    const int last = static_cast<int>(mesh.V.rows()) - 1;
    for (const std::vector<int>& held : {std::vector<int>{7}, std::vector<int>{0, last}}) {
        const Rig rig = reference::rig_of_vertices(held);
        Pose pose;
        for (std::size_t k = 0; k < held.size(); ++k) {
            pose.handles[reference::vertex_id(k)].to = mesh.V.row(held[k]).transpose() + Point(12, -5);
        }
        const Deformation result = deformed(mesh, rig, pose);
        EXPECT_LT((result.V - (mesh.V.rowwise() + Eigen::RowVector2d(12, -5))).cwiseAbs().maxCoeff(), 1e-9);
    }
}

TEST_P(HardRigs, EveryVertexHeldAndFarTargets) {
    const TriangleMesh mesh = reference::grid(3, 3, 30, 30);
    Rig rig;
    rig.handles.push_back({"all", RegionHandle{{{-1, -1}, {31, -1}, {31, 31}, {-1, 31}}}});
    Pose pose;
    pose.handles["all"].rotate_rad = std::acos(-1) / 2;
    const Deformation result = deformed(mesh, rig, pose);
    EXPECT_LT((result.V.row(0) - Eigen::RowVector2d(30, 0)).norm(), 1e-12);

    Pose far;
    far.handles["p1"].to = Point(2e7, 1e6);
    const Deformation pulled = deformed(mesh, reference::rig_of_points({{5, 5}, {25, 25}}), far);
    EXPECT_TRUE(pulled.V.allFinite());
    EXPECT_LT(pulled.max_handle_error_px, 1e-6 * 42);
    far.handles["p1"].to = Point(1e12, 1e12);
    EXPECT_ANY_THROW(deformed(mesh, reference::rig_of_points({{5, 5}, {25, 25}}), far));
}

TEST_P(HardRigs, PointsInsideRegionsFollowThem) {
    const TriangleMesh mesh = reference::grid(20, 20, 200, 200);
    Rig rig = reference::rig_of_points({{100, 100}, {20, 180}});
    rig.handles.push_back({"region", RegionHandle{{{50, 50}, {150, 50}, {150, 150}, {50, 150}}}});
    Pose pose;
    pose.handles["region"].rotate_rad = 0.4;
    EXPECT_LT(deformed(mesh, rig, pose).max_handle_error_px, 1e-8);
}

// Discs along bones overlap: their means are nearly the same numbers.
TEST_P(HardRigs, ManyOverlappingHoldsAreMet) {
    namespace places = reference::figure_places;
    const TriangleMesh mesh = reference::figure(1000, 10);
    Rig rig = reference::rig_of_points({1000 * places::head, 1000 * places::left_foot});
    rig.handles.push_back({"arm", BoneHandle{1000 * places::left_hand, 1000 * Point(0.42, 0.42), {}}});
    rig.handles.push_back({"spine", BoneHandle{1000 * Point(0.5, 0.4), 1000 * Point(0.5, 0.65), {}}});
    rig.handles.push_back({"leg", BoneHandle{1000 * places::right_foot, 1000 * Point(0.55, 0.7), {}}});
    Pose pose;
    pose.handles["arm"].rotate_rad = 0.4;
    pose.handles["leg"].rotate_rad = -0.2;
    pose.handles["p0"].scale = 1.3;
    EXPECT_LT(deformed(mesh, rig, pose).max_handle_error_px, 1e-9);
}

TEST_P(HardRigs, SliversGiveNumbers) {
    TriangleMesh mesh = reference::grid(12, 12, 120, 120);
    mesh.V.row(reference::nearest_vertex(mesh, {60, 60})) += Eigen::RowVector2d(9.9999, 0.00001);
    const Deformation one = deformed(mesh, reference::rig_of_points({{20, 20}, {100, 90}}), Pose());
    EXPECT_LT((one.V - mesh.V).cwiseAbs().maxCoeff(), 1e-9);
    Pose pose;
    pose.handles["p1"].to = Point(90, 110);
    EXPECT_TRUE(deformed(mesh, reference::rig_of_points({{20, 20}, {100, 90}}), pose).V.allFinite());
}

INSTANTIATE_TEST_SUITE_P(Methods, HardRigs,
                         testing::Values(Method::laplacian, Method::laplacian_rotated, Method::laplacian_similarity,
                                         Method::multiresolution));

}  // namespace
}  // namespace puppetwarp
