#include "reference/test_meshes.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/deform/interactive_solver.h>
#include <puppetwarp/mesh/distortion.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace puppetwarp {
namespace {

namespace places = reference::figure_places;
constexpr double size = 600;
constexpr double ages_ms = 1e6;

Rig figure_rig() {
    return reference::rig_of_points({size * places::head, size * places::left_hand, size * places::right_hand,
                                     size * places::left_foot, size * places::right_foot, size * places::chest});
}

Pose moved(double share) {
    Pose pose;
    pose.handles["p2"].to = size * (places::right_hand + share * Point(-0.1, -0.25));
    pose.handles["p1"].to = size * (places::left_hand + share * Point(0.05, 0.2));
    return pose;
}

double distance(const Eigen::MatrixX2d& a, const Eigen::MatrixX2d& b) {
    return (a - b).rowwise().norm().maxCoeff();
}

InteractiveFrame until_converged(InteractiveSolver& solver, const Pose& pose, double budget_ms = 0) {
    InteractiveFrame frame;
    for (int call = 0; call < 5000 && !frame.converged; ++call) frame = solver.advance(pose, budget_ms);
    EXPECT_TRUE(frame.converged);
    return frame;
}

class InteractiveSolverTest : public testing::TestWithParam<Method> {
protected:
    MethodOptions options() const {
        MethodOptions options;
        options.method = GetParam();
        options.tolerance = 1e-10;
        return options;
    }
    const TriangleMesh mesh_ = reference::figure(size, 12);
};

std::string name_of(const testing::TestParamInfo<Method>& each) {
    std::string name = method_name(each.param);
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

TEST_P(InteractiveSolverTest, EndsWhereADeformationFromThereEnds) {
    const auto deformer = make_deformer(options(), mesh_, figure_rig());
    Progress progress;
    for (const bool worker : {false, true}) {
        InteractiveSolver solver(options(), mesh_, figure_rig(), worker);
        Eigen::MatrixX2d before = until_converged(solver, moved(0)).V;
        for (const double share : {0.3, 0.5, 1.0, 0.9}) {
            const InteractiveFrame frame = until_converged(solver, moved(share));
            const Deformation expected = deformer->deform(moved(share), &before, progress);
            EXPECT_LT(distance(frame.V, expected.V), 0.01) << share;
            EXPECT_TRUE(frame.settled);
            before = frame.V;
        }
    }
}

TEST_P(InteractiveSolverTest, NoTimeIsOneIteration) {
    InteractiveSolver solver(options(), mesh_, figure_rig(), true);
    for (int k = 1; k <= 30; ++k) {
        const InteractiveFrame frame = solver.advance(moved(k / 20.0), 0);
        EXPECT_LE(frame.iterations, 1);
        EXPECT_TRUE(frame.V.allFinite());
    }
}

TEST_P(InteractiveSolverTest, WithoutAWorkerTheSameTwice) {
    const auto end = [&] {
        InteractiveSolver solver(options(), mesh_, figure_rig(), false);
        for (const double share : {0.2, 0.6, 1.0}) solver.advance(moved(share), ages_ms);
        return solver.advance(moved(1), ages_ms).V;
    };
    EXPECT_EQ(end(), end());
}

TEST_P(InteractiveSolverTest, ABadPoseChangesNothing) {
    InteractiveSolver solver(options(), mesh_, figure_rig(), false), other(options(), mesh_, figure_rig(), false);
    solver.advance(moved(1), 0);
    other.advance(moved(1), 0);
    Pose unknown, nowhere;
    unknown.handles["nobody"].to = Point(1, 1);
    nowhere.handles["p1"].to = Point(std::nan(""), 1);
    EXPECT_THROW(solver.advance(unknown, 0), InvalidInput);
    EXPECT_THROW(solver.advance(nowhere, 0), InvalidInput);
    Rig outside = figure_rig();
    outside.handles.push_back({"out", PointHandle{{-500, -500}, {}}});
    EXPECT_THROW(solver.set_rig(outside), InvalidInput);
    EXPECT_EQ(solver.advance(moved(1), 0).V, other.advance(moved(1), 0).V);
}

TEST_P(InteractiveSolverTest, AnotherRigGoesOnFromThePositions) {
    Progress progress;
    std::vector<Rig> rigs(4, figure_rig());
    rigs[0].handles.push_back({"belly", PointHandle{size * places::belly, {}}});
    rigs[1].handles.erase(rigs[1].handles.begin());
    rigs[2].handles.push_back({"v", VertexHandle{reference::nearest_vertex(mesh_, size * Point(0.5, 0.6))}});
    rigs[3].handles.push_back({"r", RegionHandle{{size * Point(0.45, 0.55), size * Point(0.55, 0.55),
                                                  size * Point(0.55, 0.65), size * Point(0.45, 0.65)},
                                                 Falloff::none}});
    for (const Rig& rig : rigs) {
        for (const bool worker : {false, true}) {
            InteractiveSolver solver(options(), mesh_, figure_rig(), worker);
            const Eigen::MatrixX2d before = until_converged(solver, moved(0.5)).V;
            solver.advance(moved(0.5), 0);
            solver.set_rig(rig);
            const InteractiveFrame frame = until_converged(solver, moved(0.6));
            const Deformation fresh = make_deformer(options(), mesh_, rig)->deform(moved(0.6), &before, progress);
            EXPECT_LT(distance(frame.V, fresh.V), 0.01) << rig.handles.back().id;
        }
    }
}

TEST_P(InteractiveSolverTest, FarPosesAndHandsAcrossTheBodyStayFinite) {
    InteractiveSolver solver(options(), mesh_, figure_rig(), true);
    Pose far;
    far.handles["p1"].to = size * Point(1e5, -1e5);
    Pose across;
    across.handles["p1"].to = size * places::right_hand;
    across.handles["p2"].to = size * places::left_hand;
    for (const Pose& pose : {far, across, Pose()}) {
        for (int call = 0; call < 40; ++call) {
            const InteractiveFrame frame = solver.advance(pose, 0);
            ASSERT_TRUE(frame.V.allFinite());
            if (GetParam() == Method::fold_free) {
                ASSERT_EQ(measure_distortion(mesh_, frame.V).flipped_triangles, 0);
            }
        }
    }
}

TEST_P(InteractiveSolverTest, MayGoWhileItsWorkerWorks) {
    for (int k = 0; k < 10; ++k) {
        InteractiveSolver solver(options(), mesh_, figure_rig(), true);
        for (int call = 0; call <= k; ++call) solver.advance(moved(1 + 0.01 * call), 0);
    }
}

class CancelledSoon : public Progress {
public:
    bool cancelled() const override { return ++calls_ > 5; }

private:
    mutable int calls_ = 0;
};

TEST_P(InteractiveSolverTest, CancelledItKeepsItsPositions) {
    InteractiveSolver solver(options(), mesh_, figure_rig(), false), other(options(), mesh_, figure_rig(), false);
    solver.advance(moved(0.5), ages_ms);
    other.advance(moved(0.5), ages_ms);
    CancelledSoon progress;
    EXPECT_THROW(solver.restart(moved(1), progress), Cancelled);
    EXPECT_EQ(solver.advance(moved(0.5), 0).V, other.advance(moved(0.5), 0).V);
}

TEST_P(InteractiveSolverTest, RestartIsWhatDeformGives) {
    InteractiveSolver solver(options(), mesh_, figure_rig(), false);
    solver.advance(moved(0.5), ages_ms);
    Progress progress;
    const Deformation expected = make_deformer(options(), mesh_, figure_rig())->deform(moved(1), nullptr, progress);
    EXPECT_EQ(solver.restart(moved(1), progress).V, expected.V);
    EXPECT_LT(distance(until_converged(solver, moved(1)).V, expected.V), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Methods, InteractiveSolverTest,
                         testing::Values(Method::arap, Method::smooth_arap, Method::fold_free), name_of);

}  // namespace
}  // namespace puppetwarp
