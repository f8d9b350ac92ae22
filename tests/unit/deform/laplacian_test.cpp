// Differential coordinates against dense solves of the papers' equations, and what the papers say of them.
#include "reference/test_meshes.h"

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/rig/binding.h>

#include <gtest/gtest.h>
#include <Eigen/Dense>
#include <Eigen/SVD>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>

namespace puppetwarp {
namespace {

using reference::rig_of_points;
namespace places = reference::figure_places;
using Real = long double;
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

Deformation deformed(Method method, const TriangleMesh& mesh, const Rig& rig, const Pose& pose) {
    MethodOptions options;
    options.method = method;
    Progress progress;
    return make_deformer(options, mesh, rig)->deform(pose, nullptr, progress);
}

std::vector<std::set<int>> rings_of(const TriangleMesh& mesh) {
    std::vector<std::set<int>> rings(static_cast<std::size_t>(mesh.V.rows()));
    for (int t = 0; t < mesh.F.rows(); ++t) {
        for (const int i : {0, 1, 2}) {
            for (const int j : {0, 1, 2}) {
                if (i != j) rings[static_cast<std::size_t>(mesh.F(t, i))].insert(mesh.F(t, j));
            }
        }
    }
    return rings;
}

// Rows of (v'_i - mean of neighbours) - T_i(v') delta_i over (x_0, y_0, x_1, ...), and their targets. Without
// similarities T_i delta_i is delta_i, the target; with them (a, b, tx, ty) = (A^T A)^-1 A^T v' as Sorkine et al. 2004
// have it, equation 10.
struct Rows {
    Matrix R;
    Vector target;
};
Rows laplacian_rows(const TriangleMesh& mesh, bool similarities, const Eigen::VectorXd& weight) {
    const auto n = mesh.V.rows();
    const auto rings = rings_of(mesh);
    Rows rows{Matrix::Zero(2 * n, 2 * n), Vector::Zero(2 * n)};
    for (int i = 0; i < n; ++i) {
        const auto& ring = rings[static_cast<std::size_t>(i)];
        const Real share = 1.0L / static_cast<Real>(ring.size());
        Eigen::Matrix<Real, 2, 1> delta = mesh.V.row(i).transpose().cast<Real>();
        for (const int j : ring) delta -= share * mesh.V.row(j).transpose().cast<Real>();
        Matrix row = Matrix::Zero(2, 2 * n);
        row.block(0, 2 * i, 2, 2).setIdentity();
        for (const int j : ring) row.block(0, 2 * j, 2, 2) = -share * Matrix::Identity(2, 2);
        if (similarities) {
            std::vector<int> all(ring.begin(), ring.end());
            all.push_back(i);
            const auto count = static_cast<Eigen::Index>(all.size());
            Matrix A(2 * count, 4), pick = Matrix::Zero(2 * count, 2 * n);
            for (Eigen::Index k = 0; k < count; ++k) {
                const int j = all[static_cast<std::size_t>(k)];
                // About the vertex, so that the normal equations keep their digits.
                const Real x = mesh.V(j, 0) - mesh.V(i, 0), y = mesh.V(j, 1) - mesh.V(i, 1);
                A.block(2 * k, 0, 2, 4) << x, -y, 1, 0, y, x, 0, 1;
                pick.block(2 * k, 2 * j, 2, 2).setIdentity();
            }
            const Matrix T = (A.transpose() * A).ldlt().solve(Matrix(A.transpose() * pick));
            row.row(0) -= delta(0) * T.row(0) - delta(1) * T.row(1);
            row.row(1) -= delta(0) * T.row(1) + delta(1) * T.row(0);
        } else {
            rows.target.segment(2 * i, 2) = std::sqrt(Real(weight(i))) * delta;
        }
        rows.R.middleRows(2 * i, 2) = std::sqrt(Real(weight(i))) * row;
    }
    return rows;
}

void add_complex_row(const ComplexRow& row, std::complex<double> value, std::vector<Vector>& C, std::vector<Real>& d,
                     Eigen::Index n) {
    Vector re = Vector::Zero(2 * n), im = re;
    for (const auto& [v, c] : row) {
        re(2 * v) += c.real();
        re(2 * v + 1) -= c.imag();
        im(2 * v) += c.imag();
        im(2 * v + 1) += c.real();
    }
    C.push_back(re);
    C.push_back(im);
    d.push_back(value.real());
    d.push_back(value.imag());
}

Eigen::MatrixX2d dense_minimiser(const Rows& rows, const std::vector<Vector>& C, const std::vector<Real>& d) {
    const Eigen::Index n = rows.R.cols(), m = static_cast<Eigen::Index>(C.size());
    Matrix K = Matrix::Zero(n + m, n + m);
    Vector b = Vector::Zero(n + m);
    K.topLeftCorner(n, n) = rows.R.transpose() * rows.R;
    b.head(n) = rows.R.transpose() * rows.target;
    for (Eigen::Index i = 0; i < m; ++i) {
        K.block(n + i, 0, 1, n) = C[static_cast<std::size_t>(i)].transpose();
        K.block(0, n + i, n, 1) = C[static_cast<std::size_t>(i)];
        b(n + i) = d[static_cast<std::size_t>(i)];
    }
    const Vector x = K.partialPivLu().solve(b);
    Eigen::MatrixX2d V(n / 2, 2);
    for (Eigen::Index v = 0; v < n / 2; ++v) V.row(v) << double(x(2 * v)), double(x(2 * v + 1));
    return V;
}

class LinearLaplacianTest : public testing::TestWithParam<Method> {
protected:
    bool similarities() const { return GetParam() == Method::laplacian_similarity; }
};

// A point with angle and scale, one without, a bone, and a region or none.
Rig mixed_rig(double size, bool region) {
    Rig rig = rig_of_points({size * places::head, size * places::right_foot});
    rig.handles.push_back({"arm", BoneHandle{size * Point(0.42, 0.42), size * Point(0.2, 0.3), {}}});
    if (region) {
        rig.handles.push_back(
            {"belly", RegionHandle{{size * Point(0.4, 0.6), size * Point(0.62, 0.6), size * Point(0.5, 0.75)}}});
    }
    return rig;
}

Pose mixed_pose(double size) {
    Pose pose;
    pose.handles["p0"].to = size * (places::head + Point(0.05, 0.02));
    pose.handles["p0"].rotate_rad = 0.6;
    pose.handles["p0"].scale = 1.2;
    pose.handles["p1"].to = size * (places::right_foot + Point(0.1, -0.15));
    pose.handles["arm"].rotate_rad = -0.4;
    return pose;
}

TEST_P(LinearLaplacianTest, IsTheMinimiserOfThePapersEquations) {
    const double size = 600;
    const TriangleMesh mesh = reference::figure(size, 22);
    ASSERT_GT(mesh.V.rows(), 200);
    for (const bool region : {false, true}) {
        SCOPED_TRACE(region ? "with a region" : "without");
        Rig rig = mixed_rig(size, region);
        Eigen::VectorXd weight = Eigen::VectorXd::Ones(mesh.V.rows());
        if (region) {
            rig.stiffness.push_back(StiffnessRegion{{{0, 0}, {size, 0}, {size, size / 2}, {0, size / 2}}, 9});
            const Eigen::VectorXd triangles = triangle_stiffness(mesh, rig.stiffness);
            for (int v = 0; v < mesh.V.rows(); ++v) {
                double sum = 0, count = 0;
                for (int t = 0; t < mesh.F.rows(); ++t) {
                    if ((mesh.F.row(t).array() == v).any()) sum += triangles(t), ++count;
                }
                weight(v) = sum / count;
            }
        }
        Pose pose = mixed_pose(size);
        if (region) pose.handles["belly"].rotate_rad = 0.3;

        const Binding binding = take_hold(mesh, rig, "test");
        const Targets targets = resolve(binding, mesh, rig, pose, AffineUse::no, "test");
        const Eigen::VectorXcd rest = complex_positions(mesh.V);
        std::vector<Vector> C;
        std::vector<Real> d;
        for (std::size_t h = 0; h < binding.holds.size(); ++h) {
            const Hold& hold = binding.holds[h];
            add_complex_row(hold.mean, row_value(hold.mean, rest) + targets.holds[h].move, C, d, rest.size());
            if (targets.holds[h].rotate_rad) {
                add_complex_row(hold.turn, std::polar(*targets.holds[h].scale, *targets.holds[h].rotate_rad), C, d,
                                rest.size());
            }
        }
        for (std::size_t k = 0; k < binding.vertices.size(); ++k) {
            add_complex_row({{binding.vertices[k].vertex, 1.0}}, targets.vertices(static_cast<Eigen::Index>(k)), C, d,
                            rest.size());
        }
        const Eigen::MatrixX2d expected = dense_minimiser(laplacian_rows(mesh, similarities(), weight), C, d);
        const Deformation result = deformed(GetParam(), mesh, rig, pose);
        EXPECT_LT((result.V - expected).cwiseAbs().maxCoeff(), 1e-9 * size);
        EXPECT_GT((result.V - mesh.V).cwiseAbs().maxCoeff(), 0.05 * size);
    }
}

TEST_P(LinearLaplacianTest, FineMeshesStayExactUnderTranslation) {
    const TriangleMesh mesh = reference::figure(1000, 4.5);
    ASSERT_GT(mesh.V.rows(), 18000);
    const Rig rig = rig_of_points({1000 * places::head, 1000 * places::left_hand, 1000 * places::right_hand,
                                   1000 * places::left_foot, 1000 * places::right_foot, 1000 * places::chest});
    MethodOptions options;
    options.method = GetParam();
    Progress progress;
    const auto deformer = make_deformer(options, mesh, rig);
    Pose all, one, both;
    for (const Handle& handle : rig.handles) {
        all.handles[handle.id].to = both.handles[handle.id].to =
            std::get<PointHandle>(handle.shape).at + Point(123, -77);
    }
    one.handles["p2"].to = 1000 * places::right_hand + Point(-90, 60);
    both.handles["p2"].to = *one.handles["p2"].to + Point(123, -77);
    const Eigen::MatrixX2d moved = deformer->deform(all, nullptr, progress).V;
    EXPECT_LT((moved - (mesh.V.rowwise() + Eigen::RowVector2d(123, -77))).cwiseAbs().maxCoeff(), 1e-9 * 1000);
    // And what is not a translation follows it.
    const Eigen::MatrixX2d waved = deformer->deform(one, nullptr, progress).V;
    const Eigen::MatrixX2d sum = waved.rowwise() + Eigen::RowVector2d(123, -77);
    EXPECT_LT((deformer->deform(both, nullptr, progress).V - sum).cwiseAbs().maxCoeff(), 1e-9 * 1000);
}

INSTANTIATE_TEST_SUITE_P(Methods, LinearLaplacianTest, testing::Values(Method::laplacian, Method::laplacian_similarity),
                         [](const auto& each) { return each.param == Method::laplacian ? "plain" : "similarity"; });

Pose posed(const Rig& rig, const std::function<Point(const Point&)>& map) {
    Pose pose;
    for (const Handle& handle : rig.handles) {
        pose.handles[handle.id].to = map(std::get<PointHandle>(handle.shape).at);
    }
    return pose;
}

Eigen::MatrixX2d mapped(const TriangleMesh& mesh, const std::function<Point(const Point&)>& map) {
    Eigen::MatrixX2d V = mesh.V;
    for (Eigen::Index v = 0; v < V.rows(); ++v) V.row(v) = map(V.row(v).transpose()).transpose();
    return V;
}

Rig figure_rig(double size) {
    return rig_of_points({size * places::head, size * places::left_hand, size * places::right_hand,
                          size * places::left_foot, size * places::right_foot});
}

// Laplacian vectors do not turn: what is missed of a rotation by theta is (1 - e^(i theta)) times what they alone make.
TEST(Laplacian, FailsHonestlyUnderRotation) {
    const TriangleMesh mesh = reference::figure(500, 14);
    const Rig rig = figure_rig(500);
    const auto missed = [&](double angle) {
        const auto map = [&](const Point& p) { return reference::rigid(p, Point(250, 250), angle, Point(0, 0)); };
        const Eigen::MatrixX2d V = deformed(Method::laplacian, mesh, rig, posed(rig, map)).V;
        return (V - mapped(mesh, map)).rowwise().norm().maxCoeff();
    };
    const double half = missed(std::numbers::pi);
    EXPECT_GT(half, 0.1 * 500);
    for (const double angle : {0.1, 0.5, 1.5, 2.5}) {
        EXPECT_NEAR(missed(angle) / half, std::sin(angle / 2), 1e-9);
    }
}

TEST(Laplacian, TakesAffineMapsOfPoints) {
    const double size = 500;
    const TriangleMesh mesh = reference::figure(size, 10);
    Rig rig = figure_rig(size);
    Pose pose;
    pose.handles["p0"].affine = {{1.2, 0.3, -0.1, 0.9, 20, -30}};
    const Deformation result = deformed(Method::laplacian, mesh, rig, pose);
    EXPECT_LT(result.max_handle_error_px, 1e-9);
    // f_z = (a + d) / 2 + i (b - c) / 2
    const double disc = default_disc_share * bounding_diagonal(mesh.V);
    const std::complex<double> turn = reference::mean_turn(mesh, result.V, size * places::head, disc);
    EXPECT_LT(std::abs(turn - std::complex<double>(1.05, 0.2)), 1e-9);
    pose.handles["p0"].affine = {{1, 0, 0, 1, 20, -30}};
    EXPECT_ANY_THROW(deformed(Method::laplacian_similarity, mesh, rig, pose));
}

TEST(LaplacianSimilarity, ReproducesSimilaritiesExactly) {
    const TriangleMesh mesh = reference::figure(500, 10);
    const Rig rig = figure_rig(500);
    for (const double scale : {0.3, 1.0, 2.5}) {
        const auto map = [&](const Point& p) {
            return Point(scale * reference::rigid(p, Point(250, 250), 2.2, Point(30, 10)));
        };
        const Deformation result = deformed(Method::laplacian_similarity, mesh, rig, posed(rig, map));
        EXPECT_LT((result.V - mapped(mesh, map)).cwiseAbs().maxCoeff(), 1e-9 * 500);
        EXPECT_LT(result.energy, 1e-15);
    }
}

TEST(LaplacianSimilarity, OneTurnedPointTurnsEverything) {
    const TriangleMesh mesh = reference::blob(500, 30, 3);
    const Rig rig = rig_of_points({{260, 240}});
    Pose pose;
    pose.handles["p0"].to = Point(300, 200);
    pose.handles["p0"].rotate_rad = 2.9;
    const auto turned = [](const Point& p) { return reference::rigid(p, Point(260, 240), 2.9, Point(40, -40)); };
    EXPECT_LT((deformed(Method::laplacian_similarity, mesh, rig, pose).V - mapped(mesh, turned)).cwiseAbs().maxCoeff(),
              1e-9);
    pose.handles["p0"].rotate_rad.reset();
    pose.handles["p0"].scale = 1.7;
    const auto scaled = [](const Point& p) { return Point(Point(300, 200) + 1.7 * (p - Point(260, 240))); };
    EXPECT_LT((deformed(Method::laplacian_similarity, mesh, rig, pose).V - mapped(mesh, scaled)).cwiseAbs().maxCoeff(),
              1e-9);
    pose.handles["p0"].scale.reset();
    const auto moved = [](const Point& p) { return Point(p + Point(40, -40)); };
    EXPECT_LT((deformed(Method::laplacian_similarity, mesh, rig, pose).V - mapped(mesh, moved)).cwiseAbs().maxCoeff(),
              1e-9);
}

TEST(LaplacianRotated, ReproducesRigidMotions) {
    for (const double edge : {20.0, 6.0}) {
        const TriangleMesh mesh = reference::figure(500, edge);
        const Rig rig = figure_rig(500);
        for (const double angle : {0.3, 3.1, -2.0}) {
            const auto map = [&](const Point& p) { return reference::rigid(p, Point(100, 50), angle, Point(70, -20)); };
            const Deformation result = deformed(Method::laplacian_rotated, mesh, rig, posed(rig, map));
            EXPECT_LT((result.V - mapped(mesh, map)).cwiseAbs().maxCoeff(), 1e-9 * 500);
            EXPECT_TRUE(result.converged);
        }
    }
}

TEST(LaplacianRotated, DoesNotDependOnTheFrame) {
    const TriangleMesh mesh = reference::figure(500, 14);
    const Rig rig = figure_rig(500);
    const auto bend = [](const Point& p) { return Point(p + Point(0.1 * p.y(), 0.0006 * p.x() * p.x())); };
    const auto turn = [](const Point& p) { return reference::rigid(p, Point(250, 250), 2.4, Point(10, 20)); };
    const Deformation straight = deformed(Method::laplacian_rotated, mesh, rig, posed(rig, bend));
    const Deformation turned =
        deformed(Method::laplacian_rotated, mesh, rig, posed(rig, [&](const Point& p) { return turn(bend(p)); }));
    TriangleMesh result = mesh;
    result.V = straight.V;
    EXPECT_LT((turned.V - mapped(result, turn)).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_TRUE(turned.converged);
    EXPECT_GT((straight.V - mesh.V).cwiseAbs().maxCoeff(), 20);
}

std::array<double, 6> rigid_motion(const Point& centre, double angle, const Point& move) {
    const Point origin = reference::rigid({0, 0}, centre, angle, move);
    return {std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle), origin.x(), origin.y()};
}

// At the end K^T (K x - r delta) pushes on nothing that is free, with r from the result itself.
TEST(LaplacianRotated, EndsWhereTurnsAndPositionsAgree) {
    const TriangleMesh mesh = reference::grid(24, 6, 240, 60, 0.2, 5);
    Rig rig;
    rig.handles.push_back({"a", RegionHandle{{{-1, -1}, {25, -1}, {25, 61}, {-1, 61}}}});
    rig.handles.push_back({"b", RegionHandle{{{215, -1}, {241, -1}, {241, 61}, {215, 61}}}});
    Pose pose;
    pose.handles["b"].affine = rigid_motion({228, 30}, 1.2, {-48, 90});
    MethodOptions options;
    options.method = Method::laplacian_rotated;
    options.tolerance = 1e-12;
    Progress progress;
    const Deformation result = make_deformer(options, mesh, rig)->deform(pose, nullptr, progress);
    ASSERT_TRUE(result.converged);

    const auto rings = rings_of(mesh);
    const auto n = mesh.V.rows();
    std::vector<Eigen::Matrix2d> own(static_cast<std::size_t>(n));
    Eigen::MatrixXd near = Eigen::MatrixXd::Identity(n, n), K = near;
    for (int i = 0; i < n; ++i) {
        const auto& ring = rings[static_cast<std::size_t>(i)];
        own[static_cast<std::size_t>(i)].setZero();
        for (const int j : ring) {
            near(i, j) = 1;
            K(i, j) = -1.0 / static_cast<double>(ring.size());
            own[static_cast<std::size_t>(i)] +=
                (mesh.V.row(j) - mesh.V.row(i)).transpose() * (result.V.row(j) - result.V.row(i));
        }
    }
    const Eigen::MatrixXd wide = near * near;
    Eigen::MatrixX2d missed = K * result.V;
    const Eigen::MatrixX2d delta = K * mesh.V;
    for (int i = 0; i < n; ++i) {
        Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
        for (int j = 0; j < n; ++j) covariance += wide(i, j) * own[static_cast<std::size_t>(j)];
        const Eigen::JacobiSVD<Eigen::Matrix2d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
        Eigen::Matrix2d V = svd.matrixV();
        if ((V * svd.matrixU().transpose()).determinant() < 0) V.col(1) *= -1;
        missed.row(i) -= (V * svd.matrixU().transpose() * delta.row(i).transpose()).transpose();
    }
    const Eigen::MatrixX2d push = K.transpose() * missed;
    double largest = 0;
    for (int v = 0; v < n; ++v) {
        if (mesh.V(v, 0) > 25 && mesh.V(v, 0) < 215) largest = std::max(largest, push.row(v).norm());
    }
    EXPECT_LT(largest, 1e-8);
    EXPECT_GT(missed.cwiseAbs().maxCoeff(), 1e-3);
}

// Lipman et al. 2004: a strip bent by its ends stays upright on its middle line where vectors turn, and is sheared flat
// where they do not.
TEST(LaplacianRotated, BendsAStripWithoutShear) {
    const TriangleMesh mesh = reference::grid(60, 6, 600, 60);
    Rig rig;
    rig.handles.push_back({"a", RegionHandle{{{-1, -1}, {15, -1}, {15, 61}, {-1, 61}}}});
    rig.handles.push_back({"b", RegionHandle{{{585, -1}, {601, -1}, {601, 61}, {585, 61}}}});
    // Onto the half circle of the same length.
    const double angle = std::numbers::pi * 0.9;
    const double radius = 570 / angle;
    Pose pose;
    pose.handles["b"].affine = rigid_motion(
        {585, 30}, angle, Point(15 + radius * std::sin(angle), 30 + radius * (1 - std::cos(angle))) - Point(585, 30));
    const auto shear = [&](Method method) {
        const Eigen::MatrixX2d V = deformed(method, mesh, rig, pose).V;
        const auto at = [&](double x, double y) -> Eigen::RowVector2d {
            return V.row(reference::nearest_vertex(mesh, {x, y}));
        };
        const Eigen::RowVector2d along = at(310, 30) - at(290, 30), across = at(300, 60) - at(300, 0);
        return std::abs(along.normalized().dot(across.normalized()));
    };
    EXPECT_LT(shear(Method::laplacian_rotated), 0.02);
    EXPECT_GT(shear(Method::laplacian), 0.8);
}

TEST(LaplacianRotated, SaysWhenItDidNotSettle) {
    const TriangleMesh mesh = reference::figure(500, 14);
    Pose pose;
    pose.handles["p1"].to = 500 * (places::left_hand + Point(0.2, 0.1));
    MethodOptions options;
    options.method = Method::laplacian_rotated;
    options.max_iterations = 3;
    Progress progress;
    const Deformation result = make_deformer(options, mesh, figure_rig(500))->deform(pose, nullptr, progress);
    EXPECT_FALSE(result.converged);
    EXPECT_EQ(result.iterations, 3);
    EXPECT_LT(result.max_handle_error_px, 1e-9);
}

class TurnsOfPoints : public testing::TestWithParam<Method> {};

// Angle and scale, each free or fixed, seen from outside.
TEST_P(TurnsOfPoints, AreMetInAllFourCombinations) {
    const double size = 500;
    const TriangleMesh mesh = reference::figure(size, 9);
    const double disc = default_disc_share * bounding_diagonal(mesh.V);
    const bool free_scale = GetParam() != Method::laplacian && GetParam() != Method::multiresolution;
    for (const bool angle : {false, true}) {
        for (const bool scale : {false, true}) {
            Pose pose;
            pose.handles["p1"].to = size * (places::left_hand + Point(0.06, 0.03));
            if (angle) pose.handles["p1"].rotate_rad = 0.7;
            if (scale) pose.handles["p1"].scale = 1.3;
            if (scale) pose.handles["p4"].scale = 0.4;
            const Deformation result = deformed(GetParam(), mesh, figure_rig(size), pose);
            EXPECT_LT(result.max_handle_error_px, 1e-8);
            const std::complex<double> turn = reference::mean_turn(mesh, result.V, size * places::left_hand, disc);
            if (angle) {
                EXPECT_NEAR(std::arg(turn), 0.7, 1e-9);
            }
            if (scale) {
                EXPECT_NEAR(std::abs(turn), 1.3, 1e-9);
            }
            if (angle && !scale && !free_scale) {
                EXPECT_NEAR(std::abs(turn), 1, 1e-9);
            }
            if (!scale) continue;
            EXPECT_NEAR(std::abs(reference::mean_turn(mesh, result.V, size * places::right_foot, disc)), 0.4, 1e-9);
        }
    }
}

TEST_P(TurnsOfPoints, NeverEndHalfATurnTooFar) {
    const double size = 500;
    const TriangleMesh mesh = reference::figure(size, 12);
    const double disc = default_disc_share * bounding_diagonal(mesh.V);
    Pose pose;
    pose.handles["p1"].rotate_rad = 2.8;
    const Deformation result = deformed(GetParam(), mesh, figure_rig(size), pose);
    EXPECT_LT(result.max_handle_error_px, 1e-8);
    EXPECT_NEAR(std::arg(reference::mean_turn(mesh, result.V, size * places::left_hand, disc)), 2.8, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Methods, TurnsOfPoints,
                         testing::Values(Method::laplacian, Method::laplacian_rotated, Method::laplacian_similarity,
                                         Method::multiresolution));

}  // namespace
}  // namespace puppetwarp
