// Drags as people make them: at random, round in circles, in one go.
#include "reference/random_drags.h"
#include "reference/test_meshes.h"

#include <puppetwarp/mesh/distortion.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puppetwarp {
namespace {

namespace places = reference::figure_places;
constexpr double degree = std::numbers::pi / 180;
constexpr double size = 600;
const Point right_shoulder = size * places::right_shoulder;
const Point left_shoulder = size * Point(0.42, 0.42);
const Point right_hand = size * places::right_hand;
const Point left_hand = size * places::left_hand;

MethodOptions options_for(Method method) {
    MethodOptions options;
    options.method = method;
    return options;
}

Rig figure_rig() {
    return reference::rig_of_points({size * places::head, left_hand, right_hand, size * places::left_foot,
                                     size * places::right_foot, size * places::chest, right_shoulder, left_shoulder});
}

double distance(const Eigen::MatrixX2d& a, const Eigen::MatrixX2d& b) {
    return (a - b).rowwise().norm().maxCoeff();
}

Deformation from_rest(Method method, const TriangleMesh& mesh, const Rig& rig, const Pose& pose) {
    Progress progress;
    return make_deformer(options_for(method), mesh, rig)->deform(pose, nullptr, progress);
}

InteractiveFrame until_converged(InteractiveSolver& solver, const Pose& pose) {
    InteractiveFrame frame;
    for (int call = 0; call < 2000; ++call) {
        frame = solver.advance(pose, 0);
        if (frame.converged) break;
    }
    EXPECT_TRUE(frame.converged);
    return frame;
}

// \param right, left  how far each arm is turned about its shoulder.
Pose turned_arms(double right, double left) {
    Pose pose;
    if (right != 0) pose.handles["p2"].to = reference::rigid(right_hand, right_shoulder, right * degree, {0, 0});
    if (left != 0) pose.handles["p1"].to = reference::rigid(left_hand, left_shoulder, left * degree, {0, 0});
    return pose;
}

class MethodTest : public testing::TestWithParam<Method> {};

std::string name_of(const testing::TestParamInfo<Method>& each) {
    std::string name = method_name(each.param);
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

TEST(RandomDrags, FoldFreeNeverFolds) {
    for (const bool worker : {false, true}) {
        MethodOptions options = options_for(Method::fold_free);
        options.max_iterations = 100;
        reference::RandomDrags drags(options, 11, 300, worker);
        for (int k = 0; k < 150; ++k) drags.drag();
        EXPECT_EQ(drags.tally().folds, 0) << drags.tally().worst_at;
        EXPECT_EQ(drags.tally().not_finite, 0) << drags.tally().worst_at;
        EXPECT_LE(drags.tally().worst_rise, 1e-12);
        EXPECT_GT(drags.tally().calls, 400);
    }
}

// The seeds met regions with points inside of them, angles that contradict each other, targets that crush a disc.
TEST(RandomDrags, TheOthersStayFinite) {
    for (const Method method : {Method::arap, Method::smooth_arap}) {
        for (const std::uint32_t seed : {1u, 4u}) {
            MethodOptions options = options_for(method);
            options.max_iterations = 100;
            reference::RandomDrags drags(options, seed, 300, false);
            for (int k = 0; k < 80; ++k) drags.drag();
            EXPECT_EQ(drags.tally().not_finite, 0) << drags.tally().worst_at;
            EXPECT_LE(drags.tally().worst_rise, 1e-12);
        }
    }
}

TEST_P(MethodTest, APoseReachedRoundACircleComesBackFromItsTurns) {
    const TriangleMesh mesh = reference::figure(size, 12);
    struct Way {
        double right, left;
    };
    for (const Way& way : {Way{720, 0}, Way{-360, 0}, Way{360, -360}}) {
        InteractiveSolver solver(options_for(GetParam()), mesh, figure_rig(), false);
        const int steps = static_cast<int>(std::max(std::abs(way.right), std::abs(way.left)) / 10);
        Pose pose;
        for (int k = 1; k <= steps; ++k) {
            pose = turned_arms(way.right * k / steps, way.left * k / steps);
            until_converged(solver, pose);
        }
        const InteractiveFrame dragged = until_converged(solver, pose);
        Pose saved = pose;
        for (const auto& [id, turn] : solver.turns()) saved.handles[id].turn_rad = turn;
        const Deformation opened = from_rest(GetParam(), mesh, figure_rig(), saved);
        EXPECT_TRUE(opened.converged);
        EXPECT_LT(distance(dragged.V, opened.V), 0.1) << way.right << " " << way.left;
    }
}

TEST_P(MethodTest, ATailWoundUpComesBackFromItsTurns) {
    const TriangleMesh mesh = reference::grid(40, 4, 600, 60, 0.2, 3);
    const Rig rig = reference::rig_of_points({{30, 30}, {150, 30}, {570, 30}, {30, 10}, {30, 50}, {90, 30}});
    InteractiveSolver solver(options_for(GetParam()), mesh, rig, false);
    Pose pose;
    for (int k = 1; k <= 54; ++k) {
        // Round and inwards, as a tail curls.
        const double share = k / 54.0;
        pose.handles["p2"].to =
            Point(150, 30) +
            (1 - 0.3 * share) * (reference::rigid({570, 30}, {150, 30}, share * 540 * degree, {0, 0}) - Point(150, 30));
        until_converged(solver, pose);
    }
    const InteractiveFrame dragged = until_converged(solver, pose);
    Pose saved = pose;
    for (const auto& [id, turn] : solver.turns()) saved.handles[id].turn_rad = turn;
    EXPECT_LT(distance(dragged.V, from_rest(GetParam(), mesh, rig, saved).V), 0.1);
}

// Against a slow hand: one degree at a time, converged each time.
TEST_P(MethodTest, AnArmSentFarInOneGoArrivesAsIfLed) {
    const TriangleMesh mesh = reference::figure(size, 12);
    Progress progress;
    const auto deformer = make_deformer(options_for(GetParam()), mesh, figure_rig());
    for (const double angle : {170.0, -170.0, 90.0, -90.0}) {
        Eigen::MatrixX2d led = mesh.V;
        for (int k = 1; k <= static_cast<int>(std::abs(angle)); ++k) {
            led = deformer->deform(turned_arms(std::copysign(k, angle), 0), &led, progress).V;
        }
        const Deformation sent = deformer->deform(turned_arms(angle, 0), nullptr, progress);
        EXPECT_TRUE(sent.converged);
        EXPECT_LT(distance(sent.V, led), 0.5) << angle;
        EXPECT_EQ(measure_distortion(mesh, sent.V).flipped_triangles, measure_distortion(mesh, led).flipped_triangles);
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, MethodTest, testing::Values(Method::arap, Method::smooth_arap, Method::fold_free),
                         name_of);

}  // namespace
}  // namespace puppetwarp
