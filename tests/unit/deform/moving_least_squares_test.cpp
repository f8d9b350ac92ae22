// Moving least squares against the matrix formulas of Schaefer et al. 2006, one vertex at a time.
#include "reference/test_meshes.h"

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/deform/mls_moments.h>
#include <puppetwarp/rig/binding.h>

#include <gmock/gmock.h>
#include <Eigen/Dense>

#include <cmath>

namespace puppetwarp {
namespace {

using reference::nearest_vertex;
using reference::rig_of_points;
namespace places = reference::figure_places;
using Complex = std::complex<double>;

Deformation deformed(Method method, const TriangleMesh& mesh, const Rig& rig, const Pose& pose) {
    MethodOptions options;
    options.method = method;
    Progress progress;
    return make_deformer(options, mesh, rig)->deform(pose, nullptr, progress);
}

const std::vector<Point> from{{100, 120}, {260, 90}, {180, 230}, {300, 310}, {90, 330}};
const std::vector<Point> to{{80, 150}, {300, 60}, {200, 260}, {280, 350}, {130, 340}};

Pose moved_pose(const std::vector<Point>& targets) {
    Pose pose;
    for (std::size_t k = 0; k < targets.size(); ++k) pose.handles["p" + std::to_string(k)].to = targets[k];
    return pose;
}

// Rows as vectors, as in the paper: l(x) = (x - p*) M + q*.
Point reference_mls(Method method, const Point& v, const std::vector<Point>& p, const std::vector<Point>& q) {
    double sum = 0;
    Eigen::RowVector2d p_mean(0, 0), q_mean(0, 0);
    std::vector<double> w;
    for (std::size_t i = 0; i < p.size(); ++i) {
        w.push_back(1 / (p[i] - v).squaredNorm());
        sum += w[i];
        p_mean += w[i] * p[i].transpose();
        q_mean += w[i] * q[i].transpose();
    }
    p_mean /= sum;
    q_mean /= sum;
    Eigen::Matrix2d PP = Eigen::Matrix2d::Zero(), PQ = PP, turned = PP;
    double norm = 0, along = 0, across = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const Eigen::RowVector2d ph = p[i].transpose() - p_mean, qh = q[i].transpose() - q_mean;
        const Eigen::RowVector2d p_turned(-ph.y(), ph.x()), q_turned(-qh.y(), qh.x());
        Eigen::Matrix2d P, Q;
        P << ph, -p_turned;
        Q << qh, -q_turned;
        PP += w[i] * ph.transpose() * ph;
        PQ += w[i] * ph.transpose() * qh;
        turned += w[i] * P * Q.transpose();
        norm += w[i] * ph.squaredNorm();
        along += w[i] * qh.dot(ph);
        across += w[i] * qh.dot(p_turned);
    }
    const Eigen::Matrix2d M = method == Method::mls_affine       ? Eigen::Matrix2d(PP.inverse() * PQ)
                              : method == Method::mls_similarity ? Eigen::Matrix2d(turned / norm)
                                                                 : Eigen::Matrix2d(turned / std::hypot(along, across));
    return ((v.transpose() - p_mean) * M + q_mean).transpose();
}

class MlsTest : public testing::TestWithParam<Method> {};

TEST_P(MlsTest, IsThePapersFormulaAtEveryVertex) {
    const TriangleMesh mesh = reference::grid(20, 21, 400, 420, 0.25, 3);
    const Deformation result = deformed(GetParam(), mesh, rig_of_points(from), moved_pose(to));
    for (int v = 0; v < mesh.V.rows(); ++v) {
        const Point expected = reference_mls(GetParam(), mesh.V.row(v).transpose(), from, to);
        EXPECT_LT((result.V.row(v).transpose() - expected).norm(), 1e-9);
    }
    EXPECT_EQ(result.max_handle_error_px, 0);
}

TEST_P(MlsTest, InterpolatesItsPointsAlsoAtAndBesideVertices) {
    TriangleMesh mesh = reference::grid(10, 10, 400, 400);
    const int beside = nearest_vertex(mesh, {200, 200});
    mesh.V.row(beside) += Eigen::RowVector2d(1e-7, 0);
    const std::vector<Point> on{{80, 80}, {200, 200}, {320, 120}};
    const std::vector<Point> goal{{60, 100}, {230, 180}, {330, 90}};
    const Deformation result = deformed(GetParam(), mesh, rig_of_points(on), moved_pose(goal));
    EXPECT_TRUE(result.V.allFinite());
    for (std::size_t k = 0; k < on.size(); ++k) {
        EXPECT_LT((result.V.row(nearest_vertex(mesh, on[k])).transpose() - goal[k]).norm(), 1e-6);
    }
    EXPECT_EQ(result.V.row(nearest_vertex(mesh, on[0])), goal[0].transpose());
}

TEST_P(MlsTest, ReproducesTheMapsOfItsKind) {
    const TriangleMesh mesh = reference::figure(500, 14);
    const Rig rig =
        rig_of_points({500 * places::head, 500 * places::left_hand, 500 * places::right_foot, 500 * places::chest});
    const double scale = GetParam() == Method::mls_rigid ? 1 : 1.6;
    const auto map = [&](const Point& p) -> Point {
        if (GetParam() == Method::mls_affine) return {1.3 * p.x() + 0.5 * p.y() + 7, -0.2 * p.x() + 0.7 * p.y()};
        return scale * reference::rigid(p, Point(250, 250), 2.7, Point(20, -30));
    };
    Pose pose;
    for (const Handle& handle : rig.handles) {
        pose.handles[handle.id].to = map(std::get<PointHandle>(handle.shape).at);
    }
    const Deformation result = deformed(GetParam(), mesh, rig, pose);
    for (int v = 0; v < mesh.V.rows(); ++v) {
        EXPECT_LT((result.V.row(v).transpose() - map(mesh.V.row(v).transpose())).norm(), 1e-9 * 500);
    }
    EXPECT_LT(result.energy, 1e-8);
}

TEST_P(MlsTest, OneHandleTranslatesAndTurns) {
    const TriangleMesh mesh = reference::blob(400, 30, 2);
    Pose pose;
    pose.handles["p0"].to = Point(230, 170);
    Deformation result = deformed(GetParam(), mesh, rig_of_points({{200, 200}}), pose);
    EXPECT_LT((result.V - (mesh.V.rowwise() + Eigen::RowVector2d(30, -30))).cwiseAbs().maxCoeff(), 1e-10);
    pose.handles["p0"].rotate_rad = 2.5;
    result = deformed(GetParam(), mesh, rig_of_points({{200, 200}}), pose);
    for (int v = 0; v < mesh.V.rows(); ++v) {
        const Point expected = reference::rigid(mesh.V.row(v).transpose(), {200, 200}, 2.5, {30, -30});
        EXPECT_LT((result.V.row(v).transpose() - expected).norm(), 1e-9);
    }
}

TEST_P(MlsTest, HandlesOnOneLineOrInOnePlaceAreNoTrouble) {
    const TriangleMesh mesh = reference::grid(10, 10, 100, 100);
    Pose pose;
    pose.handles["p0"].to = Point(5, 40);
    pose.handles["p2"].to = Point(80, 90);
    const Rig line = rig_of_points({{10, 20}, {40, 50}, {70, 80}});
    const Method like = GetParam() == Method::mls_affine ? Method::mls_similarity : GetParam();
    const Deformation result = deformed(GetParam(), mesh, line, pose);
    EXPECT_TRUE(result.V.allFinite());
    EXPECT_EQ(result.V, deformed(like, mesh, line, pose).V);
    EXPECT_LT((result.V - mesh.V).cwiseAbs().maxCoeff(), 60);

    Pose same;
    for (const char* id : {"p0", "p1", "p2"}) same.handles[id].to = Point(60, 45);
    const Deformation moved = deformed(GetParam(), mesh, rig_of_points({{50, 50}, {50, 50}, {50, 50}}), same);
    EXPECT_LT((moved.V - (mesh.V.rowwise() + Eigen::RowVector2d(10, -5))).cwiseAbs().maxCoeff(), 1e-10);
}

// A small triangle around a point shows the field's derivatives there.
struct Derivatives {
    Complex turn, shear;
};
Derivatives derivatives_at(Method method, const Point& at, const Rig& rig, const Pose& pose) {
    TriangleMesh mesh = reference::grid(8, 8, 400, 400);
    const double h = 1e-4;
    const auto first = static_cast<int>(mesh.V.rows());
    mesh.V.conservativeResize(first + 4, 2);
    mesh.V.bottomRows(4) << at.x() + h, at.y(), at.x() - h, at.y(), at.x(), at.y() + h, at.x(), at.y() - h;
    // Thin triangles hang them on the grid: what is no part of the mesh that is held would stay.
    mesh.F.conservativeResize(mesh.F.rows() + 2, 3);
    mesh.F.bottomRows(2) << first, first + 2, 0, first + 3, first + 1, 0;
    for (Eigen::Index t = mesh.F.rows() - 2; t < mesh.F.rows(); ++t) {
        if (double_areas(mesh.V, mesh.F)(t) < 0) std::swap(mesh.F(t, 0), mesh.F(t, 1));
    }
    const Eigen::VectorXcd x = complex_positions(deformed(method, mesh, rig, pose).V);
    const Complex dx = (x(first) - x(first + 1)) / (2 * h), dy = (x(first + 2) - x(first + 3)) / (2 * h);
    return {0.5 * (dx - Complex(0, 1) * dy), 0.5 * (dx + Complex(0, 1) * dy)};
}

TEST_P(MlsTest, APointsAngleIsTheFieldsThere) {
    const Rig rig = rig_of_points(from);
    Pose pose = moved_pose(to);
    pose.handles["p1"].rotate_rad = 1.9;
    const Derivatives angle = derivatives_at(GetParam(), from[1], rig, pose);
    EXPECT_LT(std::abs(angle.turn - std::polar(1.0, 1.9)), 1e-5);
    EXPECT_LT(std::abs(angle.shear), 1e-5);
    if (GetParam() == Method::mls_rigid) return;
    pose.handles["p1"].scale = 0.6;
    EXPECT_LT(std::abs(derivatives_at(GetParam(), from[1], rig, pose).turn - std::polar(0.6, 1.9)), 1e-5);
    // The scale alone leaves the direction to the others.
    pose.handles["p1"].rotate_rad.reset();
    const Complex scaled = derivatives_at(GetParam(), from[1], rig, pose).turn;
    EXPECT_NEAR(std::abs(scaled), 0.6, 1e-5);
    pose.handles["p1"].scale.reset();
    const Complex free = derivatives_at(Method::mls_similarity, from[1], rig, pose).turn;
    EXPECT_NEAR(std::arg(scaled), std::arg(free), 1e-4);
}

TEST_P(MlsTest, BonesAndRegionsCarryWhatLiesOnThem) {
    const TriangleMesh mesh = reference::grid(20, 20, 400, 400);
    Rig rig = rig_of_points({{340, 60}});
    rig.handles.push_back({"bone", BoneHandle{{60, 100}, {60, 300}, {}}});
    rig.handles.push_back({"region", RegionHandle{{{190, 190}, {310, 190}, {310, 310}, {190, 310}}}});
    Pose pose;
    pose.handles["bone"].rotate_rad = 0.5;
    pose.handles["region"].rotate_rad = -0.7;
    pose.handles["p0"].to = Point(350, 40);
    const Deformation result = deformed(GetParam(), mesh, rig, pose);
    EXPECT_TRUE(result.V.allFinite());
    for (int v = 0; v < mesh.V.rows(); ++v) {
        const Point p = mesh.V.row(v).transpose();
        if (std::abs(p.x() - 60) < 1e-9 && p.y() > 99 && p.y() < 301) {
            EXPECT_LT((result.V.row(v).transpose() - reference::rigid(p, {60, 100}, 0.5, {0, 0})).norm(), 1e-9);
        }
        if (p.x() > 190 && p.x() < 310 && p.y() > 190 && p.y() < 310) {
            EXPECT_LT((result.V.row(v).transpose() - reference::rigid(p, {250, 250}, -0.7, {0, 0})).norm(), 1e-9);
        }
    }
    EXPECT_LT(result.max_handle_error_px, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Methods, MlsTest,
                         testing::Values(Method::mls_affine, Method::mls_similarity, Method::mls_rigid),
                         [](const auto& each) {
                             return each.param == Method::mls_affine       ? "affine"
                                    : each.param == Method::mls_similarity ? "similarity"
                                                                           : "rigid";
                         });

TEST(MovingLeastSquares, AnAffinePointShearsTheFieldThere) {
    Pose pose = moved_pose(to);
    pose.handles["p1"] = {};
    // f_z = (a + d) / 2 + i (b - c) / 2, f_zbar = (a - d) / 2 + i (b + c) / 2
    pose.handles["p1"].affine = {{1.4, 0.3, 0.1, 0.8, -20, -10}};
    const Derivatives there = derivatives_at(Method::mls_affine, from[1], rig_of_points(from), pose);
    EXPECT_LT(std::abs(there.turn - Complex(1.1, 0.1)), 1e-5);
    EXPECT_LT(std::abs(there.shear - Complex(0.3, 0.2)), 1e-5);
    EXPECT_ANY_THROW(derivatives_at(Method::mls_rigid, from[1], rig_of_points(from), pose));
}

// Schaefer et al. 2006, figures 2 and 3: pulled apart by two handles, similarities scale across too, rigid maps do not.
TEST(MovingLeastSquares, RigidMapsStretchOnlyAlong) {
    const TriangleMesh mesh = reference::grid(20, 20, 400, 400);
    Pose pose;
    pose.handles["p0"].to = Point(50, 200);
    pose.handles["p1"].to = Point(350, 200);
    const Rig rig = rig_of_points({{100, 200}, {300, 200}});
    const Eigen::MatrixX2d similar = deformed(Method::mls_similarity, mesh, rig, pose).V;
    const Eigen::MatrixX2d rigid = deformed(Method::mls_rigid, mesh, rig, pose).V;
    for (int v = 0; v < mesh.V.rows(); ++v) {
        EXPECT_NEAR(similar(v, 1) - 200, 1.5 * (mesh.V(v, 1) - 200), 1e-9);
        EXPECT_NEAR(rigid(v, 1), mesh.V(v, 1), 1e-9);
    }
}

TEST(MovingLeastSquares, RigidSaysThatItCannotScale) {
    const TriangleMesh mesh = reference::grid(6, 6, 400, 400);
    Pose pose = moved_pose(to);
    pose.handles["p1"].rotate_rad = 0.5;
    const Deformation without = deformed(Method::mls_rigid, mesh, rig_of_points(from), pose);
    EXPECT_TRUE(without.warnings.empty());
    pose.handles["p1"].scale = 2;
    const Deformation result = deformed(Method::mls_rigid, mesh, rig_of_points(from), pose);
    ASSERT_EQ(result.warnings.size(), 1u);
    EXPECT_THAT(result.warnings[0], testing::HasSubstr("'p1'"));
    EXPECT_LT((result.V - without.V).cwiseAbs().maxCoeff(), 1e-12);
}

// Against the midpoint rule on many pieces.
TEST(MlsMoments, OfASegmentAreItsIntegrals) {
    const Complex a(3, 1), b(7, 4);
    for (const Complex& v : {Complex(0, 0), Complex(5, 1.5), Complex(4.2, 2.1), Complex(-1, -2), Complex(11, 7),
                             Complex(9, 5.5 + 1e-9), Complex(2.9, 1)}) {
        MlsMoments sum;
        const int pieces = 400000;
        for (int i = 0; i < pieces; ++i) {
            const MlsMoments piece = point_moments(v, a + (b - a) * ((i + 0.5) / pieces));
            const double length = 5.0 / pieces;
            sum += {length * piece.weight, length * piece.first, length * piece.norm, length * piece.square};
        }
        const MlsMoments exact = segment_moments(v, a, b);
        EXPECT_NEAR(exact.weight, sum.weight, 1e-6 * sum.weight);
        EXPECT_LT(std::abs(exact.first - sum.first), 1e-6 * sum.weight);
        EXPECT_NEAR(exact.norm, 5, 1e-12);
        EXPECT_LT(std::abs(exact.square - sum.square), 1e-6);
    }
}

}  // namespace
}  // namespace puppetwarp
