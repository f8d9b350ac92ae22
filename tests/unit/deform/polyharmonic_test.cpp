#include "field_problem.h"

#include <puppetwarp/mesh/operators.h>
#include <puppetwarp/rig/binding.h>

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>

namespace puppetwarp {
namespace {

using reference::nearest_vertex;
using reference::rig_of_points;
using reference::rig_of_vertices;
using testing_fields::deformed;
using testing_fields::dense_answer;
using testing_fields::hold_vertices;
namespace places = reference::figure_places;

// Largest error where the inner and outer `kept` rings of an annulus are held at the values of `u`, which solves the
// equation in between.
double annulus_error(Method method, int rings, int sectors, int kept, const std::function<double(double, double)>& u) {
    const TriangleMesh mesh = reference::annulus(rings, sectors, 1, 2);
    Rig rig;
    Pose pose;
    Eigen::VectorXd exact(mesh.V.rows());
    for (int v = 0; v < mesh.V.rows(); ++v) {
        exact(v) = u(mesh.V.row(v).norm(), std::atan2(mesh.V(v, 1), mesh.V(v, 0)));
        const int ring = v / sectors;
        if (ring >= kept && ring <= rings - kept) continue;
        hold_vertices({v}, mesh.V.row(v) + Eigen::RowVector2d(exact(v), 0), rig, pose);
    }
    const Deformation result = deformed(method, mesh, rig, pose);
    EXPECT_LT((result.V.col(1) - mesh.V.col(1)).cwiseAbs().maxCoeff(), 1e-12);
    return (result.V.col(0) - mesh.V.col(0) - exact).cwiseAbs().maxCoeff();
}

using PolarFunction = std::function<double(double r, double theta)>;

TEST(Harmonic, ConvergesToPolarClosedForms) {
    const PolarFunction wave = [](double r, double theta) { return std::pow(r, 3) * std::cos(3 * theta); };
    const PolarFunction inverse_wave = [](double r, double theta) { return std::pow(r, -2) * std::sin(2 * theta); };
    for (const PolarFunction& u : {wave, inverse_wave}) {
        const double coarse = annulus_error(Method::harmonic, 8, 72, 1, u);
        const double fine = annulus_error(Method::harmonic, 16, 144, 1, u);
        EXPECT_LT(fine, 4e-3);
        EXPECT_LT(fine, coarse / 3.5);
    }
    // Rings in geometric progression have the logarithm itself.
    EXPECT_LT(annulus_error(Method::harmonic, 8, 72, 1, [](double r, double) { return std::log(r); }), 1e-12);
}

TEST(Biharmonic, ConvergesToPolarClosedForms) {
    // Values on two rings give the slopes too.
    const PolarFunction radial = [](double r, double) { return r * r * std::log(r); };
    EXPECT_LT(annulus_error(Method::biharmonic, 8, 72, 2, radial), 1e-12);
    const PolarFunction wave = [](double r, double theta) { return std::pow(r, 4) * std::cos(2 * theta); };
    const double coarse = annulus_error(Method::biharmonic, 8, 72, 2, wave);
    const double fine = annulus_error(Method::biharmonic, 32, 288, 2, wave);
    EXPECT_LT(fine, 5e-5);
    EXPECT_LT(fine, coarse / 8);
}

// With every row of L a border that is held by itself takes no slope (Stein et al. 2018).
TEST(Biharmonic, ConvergesToTheClampedPlateBetweenTwoRings) {
    Eigen::Matrix4d A;
    const auto rows_at = [&](int row, double r) {
        A.row(row) << 1, std::log(r), r * r, r * r * std::log(r);
        A.row(row + 1) << 0, 1 / r, 2 * r, r * (2 * std::log(r) + 1);
    };
    rows_at(0, 1);
    rows_at(2, 2);
    const Eigen::Vector4d c = A.partialPivLu().solve(Eigen::Vector4d(0, 0, 1, 0));
    const PolarFunction plate = [&](double r, double) {
        return c(0) + c(1) * std::log(r) + c(2) * r * r + c(3) * r * r * std::log(r);
    };
    double last = annulus_error(Method::biharmonic, 8, 48, 1, plate);
    for (const int rings : {16, 32}) {
        const double error = annulus_error(Method::biharmonic, rings, 6 * rings, 1, plate);
        EXPECT_LT(error, last / 3.5);
        last = error;
    }
    EXPECT_LT(last, 3e-4);
}

// The minimiser of a quadratic energy with constraints, in extended precision, for every kind of handle.
class PolyharmonicTest : public testing::TestWithParam<Method> {
protected:
    int order() const { return static_cast<int>(GetParam()) + 1; }
    reference::DenseEnergy dense_energy() const { return {order(), 1, 0, {}}; }
};

TEST_P(PolyharmonicTest, IsTheMinimiserADenseSystemFinds) {
    const TriangleMesh mesh = reference::grid(10, 6, 100, 60, 0.28, 6);
    Rig rig = rig_of_points({{12, 14}, {83, 20}, {48, 47}});
    for (auto& handle : rig.handles) std::get<PointHandle>(handle.shape).radius_px = 15;
    Pose pose;
    pose.handles["p0"].to = Point(25, 10);
    pose.handles["p1"].rotate_rad = 0.7;
    pose.handles["p2"].to = Point(40, 55);
    pose.handles["p2"].affine = {1.2, 0.3, -0.4, 0.8, 21, 3};
    pose.handles["p2"].to.reset();
    for (int round = 0; round < 3; ++round) {
        // Soft holds alone, with a vertex, with a region.
        if (round == 1) {
            rig.handles.push_back({"v", VertexHandle{5}});
            pose.handles["v"].to = mesh.V.row(5).transpose() + Point(-3, 4);
        }
        if (round == 2) {
            rig.handles.push_back({"r", RegionHandle{{{55, -5}, {75, -5}, {75, 28}, {55, 28}}, Falloff::none}});
            pose.handles["r"].affine = {0.9, -0.5, 0.4, 1.1, 4, 40};
        }
        const Deformation result = deformed(GetParam(), mesh, rig, pose);
        const Eigen::MatrixX2d expected = dense_answer(dense_energy(), mesh, rig, pose);
        EXPECT_LT((result.V - expected).cwiseAbs().maxCoeff(), 1e-9 * 117) << round;
    }
}

// Many discs beside each other pull against each other with large multipliers at the higher orders.
TEST_P(PolyharmonicTest, BonesKeepTheirDigits) {
    const TriangleMesh mesh = reference::figure(500, 24);
    Rig rig = rig_of_points({500 * places::head});
    rig.handles.push_back({"spine", BoneHandle{500 * places::belly, 500 * places::chest, ""}});
    rig.handles.push_back({"arm", BoneHandle{500 * places::chest, 500 * places::right_hand, "spine"}});
    rig.handles.push_back({"leg", BoneHandle{500 * places::belly, 500 * places::left_foot, "spine"}});
    Pose pose;
    pose.handles["arm"].rotate_rad = 0.6;
    pose.handles["leg"].rotate_rad = -0.4;
    pose.handles["p0"].to = 500 * places::head + Point(10, 5);
    pose.handles["p0"].rotate_rad = 0.3;
    const Deformation result = deformed(GetParam(), mesh, rig, pose);
    const Eigen::MatrixX2d expected = dense_answer(dense_energy(), mesh, rig, pose);
    EXPECT_LT((result.V - expected).cwiseAbs().maxCoeff(), 1e-9 * bounding_diagonal(mesh.V));
}

TEST_P(PolyharmonicTest, SolvesEachComponentByItself) {
    const TriangleMesh one = reference::grid(5, 4, 50, 40, 0.25, 3);
    const TriangleMesh two = reference::joined(one, reference::grid(4, 4, 30, 30, 0.25, 4), {70, 0});
    const TriangleMesh three = reference::joined(two, one, {0, 60});
    Rig rig = rig_of_points({{10, 10}, {40, 30}, {78, 9}, {92, 21}});
    for (auto& handle : rig.handles) std::get<PointHandle>(handle.shape).radius_px = 12;
    rig.handles.push_back({"v", VertexHandle{40}});
    Pose pose;
    pose.handles["p1"].to = Point(45, 35);
    pose.handles["p2"].rotate_rad = -0.4;
    const Deformation result = deformed(GetParam(), three, rig, pose);
    // Without the third, which nothing holds, the same.
    const Eigen::MatrixX2d expected = dense_answer(dense_energy(), two, rig, pose);
    const Eigen::Index n = two.V.rows();
    EXPECT_LT((result.V.topRows(n) - expected).cwiseAbs().maxCoeff(), 1e-9 * 117);
    EXPECT_EQ(result.V.bottomRows(one.V.rows()), three.V.bottomRows(one.V.rows()));
    EXPECT_EQ(result.warnings.size(), 1u);
}

// What a point held by a scale alone costs, for each direction that it might take.
TEST_P(PolyharmonicTest, AScaleAloneTakesTheTurnThatCostsLeast) {
    const TriangleMesh mesh = reference::figure(400, 9);
    const Rig rig = rig_of_points({400 * places::head, 400 * places::right_hand, 400 * places::left_hand});
    Pose pose;
    pose.handles["p0"].scale = 1.5;
    pose.handles["p1"].scale = 0.6;
    pose.handles["p1"].to = 400 * places::right_hand + Point(30, -80);
    pose.handles["p2"].to = 400 * places::left_hand + Point(0, 90);
    const Deformation free = deformed(GetParam(), mesh, rig, pose);
    const double disc = default_disc_share * bounding_diagonal(mesh.V);
    const std::complex<double> head = reference::mean_turn(mesh, free.V, 400 * places::head, disc);
    const std::complex<double> hand = reference::mean_turn(mesh, free.V, 400 * places::right_hand, disc);
    EXPECT_NEAR(std::abs(head), 1.5, 1e-9);
    EXPECT_NEAR(std::abs(hand), 0.6, 1e-9);
    const auto energy_at = [&](double head_turn, double hand_turn) {
        Pose fixed = pose;
        fixed.handles["p0"].rotate_rad = std::arg(head) + head_turn;
        fixed.handles["p1"].rotate_rad = std::arg(hand) + hand_turn;
        return deformed(GetParam(), mesh, rig, fixed).energy;
    };
    EXPECT_NEAR(energy_at(0, 0), free.energy, 1e-9 * free.energy);
    for (const double step : {-0.01, 0.01}) {
        EXPECT_GT(energy_at(step, 0), free.energy);
        EXPECT_GT(energy_at(0, step), free.energy);
        EXPECT_GT(energy_at(step, step), free.energy);
        EXPECT_GT(energy_at(step, -step), free.energy);
    }
}

TEST_P(PolyharmonicTest, MeetsAnglesAndAffineMapsOfItsDiscs) {
    const TriangleMesh mesh = reference::figure(400, 8);
    const Rig rig = rig_of_points({400 * places::head, 400 * places::right_hand, 400 * places::left_foot});
    Pose pose;
    pose.handles["p1"].rotate_rad = 0.5;
    pose.handles["p0"].rotate_rad = -0.2;
    pose.handles["p0"].scale = 1.4;
    pose.handles["p2"].affine = {1, 0.5, 0, 1, 30, -90};
    const Deformation result = deformed(GetParam(), mesh, rig, pose);
    EXPECT_LT(result.max_handle_error_px, 1e-9);
    // Seen from outside.
    const double disc = default_disc_share * bounding_diagonal(mesh.V);
    const std::complex<double> hand = reference::mean_turn(mesh, result.V, 400 * places::right_hand, disc);
    EXPECT_LT(std::abs(hand - std::polar(1.0, 0.5)), 1e-9);
    const std::complex<double> head = reference::mean_turn(mesh, result.V, 400 * places::head, disc);
    EXPECT_LT(std::abs(head - std::polar(1.4, -0.2)), 1e-9);
    const std::complex<double> foot = reference::mean_turn(mesh, result.V, 400 * places::left_foot, disc);
    EXPECT_LT(std::abs(foot - std::complex<double>(1, 0.25)), 1e-9);
}

TEST_P(PolyharmonicTest, MovingAllHandlesOfAFineMeshMovesAll) {
    const TriangleMesh mesh = reference::figure(1000, 4.3);
    ASSERT_GT(mesh.V.rows(), 20000);
    const Rig rig = rig_of_points({1000 * places::head, 1000 * places::left_hand, 1000 * places::right_hand,
                                   1000 * places::left_foot, 1000 * places::right_foot, 1000 * places::chest});
    Pose pose;
    for (const Handle& handle : rig.handles) {
        pose.handles[handle.id].to = std::get<PointHandle>(handle.shape).at + Point(123, -77);
    }
    const Eigen::MatrixX2d expected = mesh.V.rowwise() + Eigen::RowVector2d(123, -77);
    EXPECT_LT((deformed(GetParam(), mesh, rig, pose).V - expected).cwiseAbs().maxCoeff(), 1e-9 * 1400);
}

// With every row of L an affine map has energy at the border. It is the minimiser when what it does to the rows there
// is given: vertices less than `order` edges away.
TEST_P(PolyharmonicTest, AnAffineBorderAsWideAsTheOrderMakesAnAffineInside) {
    const int width = order();
    const TriangleMesh mesh = reference::grid(16, 14, 160, 140, 0.25, 3);
    Eigen::Matrix2d J;
    J << 1.3, 0.4, -0.2, 0.8;
    const Eigen::MatrixX2d expected = (mesh.V * J.transpose()).rowwise() + Eigen::RowVector2d(5, 5);
    Rig rig;
    Pose pose;
    for (int j = 0; j <= 14; ++j) {
        for (int i = 0; i <= 16; ++i) {
            const int v = j * 17 + i;
            if (std::min({i, 16 - i, j, 14 - j}) < width) hold_vertices({v}, expected.row(v), rig, pose);
        }
    }
    const Deformation result = deformed(GetParam(), mesh, rig, pose);
    EXPECT_LT((result.V - expected).cwiseAbs().maxCoeff(), 1e-9 * 213);
}

TEST_P(PolyharmonicTest, ARegionIsItsVerticesOneByOne) {
    const TriangleMesh mesh = reference::figure(500, 6);
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(0.3).toRotationMatrix();
    const auto map = [&](const Point& p) { return Point(turn * p + Point(40, -20)); };
    const Polyline torso{{190, 200}, {310, 200}, {310, 420}, {190, 420}};
    Rig rig = rig_of_points({500 * places::left_hand, 500 * places::right_foot});
    rig.handles.push_back({"torso", RegionHandle{torso, Falloff::none}});
    Pose pose;
    pose.handles["p0"].to = 500 * places::left_hand + Point(20, 60);
    pose.handles["torso"].affine = {turn(0, 0), turn(1, 0), turn(0, 1), turn(1, 1), 40, -20};
    const Deformation region = deformed(GetParam(), mesh, rig, pose);
    rig.handles.pop_back();
    pose.handles.erase("torso");
    std::size_t held = 0;
    for (int v = 0; v < mesh.V.rows(); ++v) {
        const Point p = mesh.V.row(v).transpose();
        if (p.x() < 190 || p.x() > 310 || p.y() < 200 || p.y() > 420) continue;
        hold_vertices({v}, map(p).transpose(), rig, pose);
        EXPECT_LT((region.V.row(v).transpose() - map(p)).norm(), 1e-12 * 700);
        ++held;
    }
    EXPECT_GT(held, 600u);
    const Deformation vertices = deformed(GetParam(), mesh, rig, pose);
    EXPECT_LT((region.V - vertices.V).cwiseAbs().maxCoeff(), 1e-9 * 700);
}

TEST_P(PolyharmonicTest, ARigThatGainsAndLosesPointsIsTheSameAsAnew) {
    const TriangleMesh mesh = reference::figure(500, 9);
    for (const bool with_region : {false, true}) {
        Rig rig = rig_of_points({500 * places::head, 500 * places::left_hand, 500 * places::right_hand});
        if (with_region) {
            rig.handles.push_back(
                {"torso", RegionHandle{{{220, 230}, {280, 230}, {280, 330}, {220, 330}}, Falloff::none}});
        }
        const auto first = testing_fields::made(GetParam(), mesh, rig);
        rig.handles.erase(rig.handles.begin() + 1);
        rig.handles.push_back({"more", PointHandle{500 * places::left_foot, {}}});
        Pose pose;
        pose.handles["more"].rotate_rad = 0.3;
        pose.handles["p2"].to = 500 * places::right_hand + Point(20, 20);
        Progress progress;
        const auto next = first->with_rig(rig);
        ASSERT_TRUE(next);
        EXPECT_EQ(next->deform(pose, nullptr, progress).V, deformed(GetParam(), mesh, rig, pose).V);
        rig.handles.push_back({"v", VertexHandle{7}});
        EXPECT_FALSE(next->with_rig(rig));
        rig.handles.pop_back();
        rig.stiffness.push_back(StiffnessRegion{{{0, 0}, {100, 0}, {100, 100}, {0, 100}}, 3});
        EXPECT_FALSE(next->with_rig(rig));
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, PolyharmonicTest,
                         testing::Values(Method::harmonic, Method::biharmonic, Method::triharmonic,
                                         Method::tetraharmonic),
                         [](const auto& each) { return method_name(each.param); });

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
