// Coordinates in closed form: mean value, and Cauchy, which are Green's.

#include "cages.h"
#include "reference/test_meshes.h"
#include "support/message_of.h"

#include <puppetwarp/mesh/outline.h>
#include <puppetwarp/weights/cage_polygon.h>
#include <puppetwarp/weights/cauchy.h>
#include <puppetwarp/weights/mean_value.h>

#include <gmock/gmock.h>

#include <array>

namespace puppetwarp {

using namespace tests;

namespace {

constexpr double pi = std::numbers::pi;

// A blob of 200 px about (100, 100), and a cage around it.
struct Scene {
    TriangleMesh mesh;
    Polyline cage;
};

std::vector<Scene> scenes() {
    std::vector<Scene> all;
    for (std::uint32_t seed = 1; seed <= 6; ++seed) {
        const Polyline cage = star({100, 100}, 4 + 5 * static_cast<int>(seed), 125, 190, seed);
        const TriangleMesh mesh = reference::blob(200, 16, seed);
        all.push_back({mesh, cage});
        all.push_back({mesh, reversed(cage)});
    }
    return all;
}

Weights weights_of(const Scene& scene, WeightKind kind) {
    Progress progress;
    return compute_weights(scene.mesh, {{cage_handle("hull", scene.cage)}, {}}, {.kind = kind}, progress);
}

Polyline mapped(const Polyline& cage, const Eigen::Matrix2d& A, const Point& shift) {
    Polyline moved;
    for (const Point& corner : cage) moved.push_back(A * corner + shift);
    return moved;
}

Eigen::RowVectorXcd cauchy_at(const Polyline& cage, const Point& p) {
    return cauchy_coordinates(p.transpose(), cage).C;
}

// 2D Green coordinates, with outward normals and stretch factors: u = sum phi_i v'_i + sum psi_j s_j n'_j, as Lipman,
// Levin & Cohen-Or 2008 give them in closed form (their phi has the sign of inward normals).
// \param cage  of positive area.
Point green_map(const Polyline& cage, const Polyline& moved, const Point& p) {
    const auto outward = [](const Point& along) { return Point(along.y(), -along.x()).normalized(); };
    Point u = Point::Zero();
    for (std::size_t j = 0; j < cage.size(); ++j) {
        const std::size_t k = (j + 1) % cage.size();
        const Point a = cage[k] - cage[j], b = cage[j] - p;
        const double Q = a.squaredNorm(), S = b.squaredNorm(), R = 2 * a.dot(b);
        const double BA = b.dot(a.norm() * outward(a)), root = std::sqrt(4 * S * Q - R * R);
        const double L0 = std::log(S), L1 = std::log(S + Q + R);
        const double A0 = std::atan(R / root) / root, A1 = std::atan((2 * Q + R) / root) / root;
        const double psi = -a.norm() / (4 * pi) * ((4 * S - R * R / Q) * (A1 - A0) + R / (2 * Q) * (L1 - L0) + L1 - 2);
        const double phi_k = BA / (2 * pi) * ((L1 - L0) / (2 * Q) - (A1 - A0) * R / Q);
        const double phi_j = -BA / (2 * pi) * ((L1 - L0) / (2 * Q) - (A1 - A0) * (2 + R / Q));
        const Point now = moved[k] - moved[j];
        u += phi_j * moved[j] + phi_k * moved[k] + psi * now.norm() / a.norm() * outward(now);
    }
    return u;
}

// The same formula as in the library, by angles and in more digits.
std::vector<long double> mean_value_slowly(const Polyline& cage, const Point& p) {
    const std::size_t n = cage.size();
    std::vector<long double> tangent(n), distance(n), w(n);
    for (std::size_t j = 0; j < n; ++j) {
        const long double ax = static_cast<long double>(cage[j].x()) - p.x(),
                          ay = static_cast<long double>(cage[j].y()) - p.y();
        const Point& next = cage[(j + 1) % n];
        const long double bx = static_cast<long double>(next.x()) - p.x(),
                          by = static_cast<long double>(next.y()) - p.y();
        tangent[j] = std::tan(std::atan2(ax * by - ay * bx, ax * bx + ay * by) / 2);
        distance[j] = std::hypot(ax, ay);
    }
    long double sum = 0;
    for (std::size_t j = 0; j < n; ++j) sum += w[j] = (tangent[(j + n - 1) % n] + tangent[j]) / distance[j];
    for (long double& one : w) one /= sum;
    return w;
}

}  // namespace

TEST(CageCoordinates, ReproduceWhatTheyPromise) {
    const Eigen::Matrix2d affine{{1.3, -0.4}, {0.25, 0.8}}, similarity{{0.9, -1.1}, {1.1, 0.9}};
    const Point shift(17, -40);
    for (const Scene& scene : scenes()) {
        for (const WeightKind kind : {WeightKind::mean_value, WeightKind::green, WeightKind::cauchy}) {
            const Weights weights = weights_of(scene, kind);
            EXPECT_LT(weights.partition_error, 1e-10);
            EXPECT_EQ(weights.columns.size(), scene.cage.size());
            EXPECT_TRUE(weights.warnings.empty());
            // A holomorphic map of all linear ones makes the similarities.
            const Eigen::Matrix2d A = kind == WeightKind::mean_value ? affine : similarity;
            const Eigen::MatrixX2d expected = (scene.mesh.V * A.transpose()).rowwise() + shift.transpose();
            const Eigen::MatrixX2d found = moved_by(weights, mapped(scene.cage, A, shift));
            EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-10);
            EXPECT_LT((moved_by(weights, scene.cage) - scene.mesh.V).cwiseAbs().maxCoeff(), 1e-10);
        }
    }
}

TEST(CageCoordinates, DoNotMindWhichWayACageRuns) {
    const Scene scene = scenes()[0];
    for (const WeightKind kind : {WeightKind::mean_value, WeightKind::cauchy}) {
        const Weights one = weights_of(scene, kind), other = weights_of({scene.mesh, reversed(scene.cage)}, kind);
        EXPECT_LT((one.W - other.W.rowwise().reverse()).cwiseAbs().maxCoeff(), 1e-13);
        if (one.W_imaginary.size() > 0) {
            EXPECT_LT((one.W_imaginary - other.W_imaginary.rowwise().reverse()).cwiseAbs().maxCoeff(), 1e-13);
        }
    }
}

TEST(MeanValue, AgreesWithItsFormulaInMoreDigits) {
    for (const Scene& scene : scenes()) {
        const Eigen::MatrixXd W = mean_value_coordinates(scene.mesh.V, scene.cage);
        for (Eigen::Index v = 0; v < W.rows(); ++v) {
            const std::vector<long double> expected = mean_value_slowly(scene.cage, scene.mesh.V.row(v).transpose());
            for (Eigen::Index j = 0; j < W.cols(); ++j) {
                EXPECT_NEAR(W(v, j), static_cast<double>(expected[static_cast<std::size_t>(j)]), 1e-13);
            }
        }
    }
}

TEST(MeanValue, IsLinearOnTheCageAndGoesThereContinuously) {
    const Polyline cage = star({0, 0}, 9, 50, 90, 3);
    for (std::size_t k = 0; k < cage.size(); ++k) {
        const Point &a = cage[k], &b = cage[(k + 1) % cage.size()];
        const Point inward = Point(a.y() - b.y(), b.x() - a.x()).normalized();
        for (const double along : {0.0, 0.25, 0.7}) {
            Eigen::RowVectorXd expected = Eigen::RowVectorXd::Zero(9);
            expected(static_cast<Eigen::Index>(k)) = 1 - along;
            expected(static_cast<Eigen::Index>((k + 1) % 9)) += along;
            const Point on = a + along * (b - a);
            for (const double away : {0.0, 1e-14, 1e-12, 1e-9, 1e-6, -1e-14, -1e-12, -1e-9, -1e-6}) {
                const Eigen::RowVectorXd W = mean_value_coordinates((on + away * inward).transpose(), cage);
                EXPECT_LT((W - expected).cwiseAbs().maxCoeff(), 1e-12 + 0.5 * std::abs(away)) << k << ' ' << away;
            }
        }
    }
}

TEST(MeanValue, IsDefinedOutsideToo) {
    for (std::uint32_t seed = 1; seed <= 5; ++seed) {
        const Polyline cage = star({50, 60}, 12, 20, 100, seed);
        const TriangleMesh around = reference::grid(20, 20, 400, 400, 0.25, seed);
        const Eigen::MatrixX2d P = around.V.rowwise() - Eigen::RowVector2d(150, 140);
        const Eigen::MatrixXd W = mean_value_coordinates(P, cage);
        Eigen::MatrixX2d corners(12, 2);
        for (Eigen::Index j = 0; j < 12; ++j) corners.row(j) = cage[static_cast<std::size_t>(j)].transpose();
        EXPECT_LT((W * corners - P).cwiseAbs().maxCoeff(), 1e-10);
    }
}

TEST(MeanValue, SharesTheCentreOfARegularPolygonEvenly) {
    const Eigen::MatrixXd W = mean_value_coordinates(Point(7, 9).transpose(), star({7, 9}, 11, 40, 40, 1));
    EXPECT_LT((W.array() - 1.0 / 11).abs().maxCoeff(), 1e-15);
}

TEST(Cauchy, EqualsGreenWithStretchFactors) {
    for (const Scene& scene : scenes()) {
        Polyline cage = scene.cage;
        const Weights weights = weights_of(scene, WeightKind::green);
        // The targets are a cage of another shape altogether.
        Polyline moved = star({80, 150}, static_cast<int>(cage.size()), 60, 200, 77);
        const Eigen::MatrixX2d found = moved_by(weights, moved);
        if (signed_area(cage) < 0) {
            std::reverse(cage.begin(), cage.end());
            std::reverse(moved.begin(), moved.end());
        }
        for (Eigen::Index v = 0; v < found.rows(); ++v) {
            const Point expected = green_map(cage, moved, scene.mesh.V.row(v).transpose());
            EXPECT_LT((found.row(v).transpose() - expected).norm(), 1e-12 * 400);
        }
    }
}

TEST(Cauchy, IsConformal) {
    // The integral of a holomorphic function around a circle is 0, and the trapezoidal rule has it to round-off; of
    // f_zbar conj(z) it is 2 pi r^2 f_zbar.
    const Polyline cage = star({100, 100}, 15, 125, 190, 5), moved = star({80, 150}, 15, 60, 200, 77);
    constexpr double radius = 10;
    constexpr int samples = 64;
    for (Eigen::Index v = 0; v < 40; ++v) {
        const Point centre(60 + 2.0 * static_cast<double>(v), 140 - 1.7 * static_cast<double>(v));
        Complex anti = 0, along = 0;
        for (int k = 0; k < samples; ++k) {
            const Complex w = std::polar(1.0, 2 * pi * k / samples);
            const Eigen::RowVectorXcd C = cauchy_at(cage, centre + radius * Point(w.real(), w.imag()));
            Complex f = 0;
            for (Eigen::Index j = 0; j < C.size(); ++j) f += C(j) * complex(moved[static_cast<std::size_t>(j)]);
            anti += f * w / (radius * samples);
            along += f * std::conj(w) / (radius * samples);
        }
        EXPECT_LT(std::abs(anti), 1e-13);
        EXPECT_GT(std::abs(along), 0.1);
    }
}

TEST(Cauchy, OnTheCageIsTheLimitFromInside) {
    for (const Polyline& cage : {star({0, 0}, 9, 50, 90, 3), reversed(star({0, 0}, 9, 50, 90, 4))}) {
        for (std::size_t k = 0; k < cage.size(); ++k) {
            const Point &a = cage[k], &b = cage[(k + 1) % cage.size()];
            for (const double along : {0.0, 1e-6, 0.25, 0.7}) {
                const Point on = a + along * (b - a);
                // Towards the centre is inwards. A logarithm times the distance is left over.
                const Eigen::RowVectorXcd near = cauchy_at(cage, (1 - 1e-9) * on);
                EXPECT_LT((cauchy_at(cage, on) - near).cwiseAbs().maxCoeff(), 2e-8) << k << ' ' << along;
                EXPECT_LT(std::abs(cauchy_at(cage, on).sum() - 1.0), 1e-12);
            }
        }
    }
}

TEST(Cauchy, OutsideFollowsTheCage) {
    const Polyline cage = star({0, 0}, 9, 50, 90, 3);
    const double outer = 130;
    for (int k = 0; k < 400; ++k) {
        const double angle = 2 * pi * k / 400;
        const Point p = outer * Point(std::cos(angle), std::sin(angle));
        const Eigen::RowVectorXcd C = cauchy_at(cage, p);
        Complex rest = 0;
        for (Eigen::Index j = 0; j < 9; ++j) rest += C(j) * complex(cage[static_cast<std::size_t>(j)]);
        EXPECT_LT(std::abs(C.sum() - 1.0), 1e-12);
        EXPECT_LT(std::abs(rest - complex(p)), 1e-11);
        // Nothing jumps on the way to the cage, nor across it.
        const CageFoot foot = nearest_foot(cage, p);
        const Point on = cage[foot.edge] + foot.along * (cage[(foot.edge + 1) % 9] - cage[foot.edge]);
        EXPECT_LT((cauchy_at(cage, on + 1e-9 * (p - on)) - cauchy_at(cage, on)).cwiseAbs().maxCoeff(), 1e-8);
    }
    // Nor around a corner that all this side is nearest to.
    const Polyline square{{0, 0}, {100, 0}, {100, 100}, {0, 100}};
    for (const double angle : {0.0, 0.25 * pi, 0.5 * pi}) {
        const auto beside = [&](double turn) {
            return cauchy_at(square, Point(100, 100) + 30 * Point(std::cos(angle + turn), std::sin(angle + turn)));
        };
        EXPECT_LT((beside(1e-7) - beside(-1e-7)).cwiseAbs().maxCoeff(), 1e-6);
    }
}

TEST(Cauchy, SaysHowManyVerticesLieOutside) {
    Progress progress;
    const TriangleMesh board = reference::grid(10, 10, 100, 100);
    const Rig rig{{cage_handle("hull", {{-5, -5}, {45, -5}, {45, 105}, {-5, 105}})}, {}};
    const Weights weights = compute_weights(board, rig, {.kind = WeightKind::cauchy}, progress);
    ASSERT_EQ(weights.warnings.size(), 1u);
    EXPECT_EQ(weights.warnings[0], "66 of 121 vertices lie outside the cage 'hull' and follow its nearest edge");
    EXPECT_TRUE(compute_weights(board, rig, {.kind = WeightKind::mean_value}, progress).warnings.empty());
}

TEST(CageCoordinates, TakeHundredsOfCorners) {
    const TriangleMesh mesh = reference::blob(200, 16, 2);
    for (const WeightKind kind : {WeightKind::mean_value, WeightKind::cauchy}) {
        const Polyline cage = star({100, 100}, 400, 120, 130, 8);
        const Weights weights = weights_of({mesh, cage}, kind);
        EXPECT_LT((moved_by(weights, cage) - mesh.V).cwiseAbs().maxCoeff(), 1e-10);
    }
}

TEST(CageCoordinates, RefuseCagesThatCannotBe) {
    Progress progress;
    const TriangleMesh board = reference::grid(10, 10, 100, 100);
    const auto refusal = [&](const std::vector<Handle>& handles, WeightKind kind = WeightKind::cauchy) {
        return message_of([&] { compute_weights(board, {handles, {}}, {.kind = kind}, progress); });
    };
    const Polyline frame{{-5, -5}, {105, -5}, {105, 105}, {-5, 105}};
    EXPECT_EQ(refusal({cage_handle("c", {{-5, -5}, {105, 105}, {105, -5}, {-5, 105}})}),
              "handle 'c': the cage crosses or touches itself at (50, 50) (move its corners apart there)");
    EXPECT_EQ(refusal({cage_handle("c", {{-5, -5}, {105, -5}, {105, -5}, {50, 105}})}),
              "handle 'c': corners 1 and 2 of the cage are in one place, at (105, -5) (remove one of them)");
    EXPECT_EQ(refusal({cage_handle("c", {{0, 0}, {50, 50}, {100, 100}})}),
              "handle 'c': the cage has no area (draw it around the subject)");
    EXPECT_EQ(refusal({cage_handle("c", {{0, 0}, {50, 50}, {100, 0}, {100, 100}, {50, 50}, {0, 100}})}),
              "handle 'c': the cage crosses or touches itself at (50, 50) (move its corners apart there)");
    EXPECT_EQ(refusal({cage_handle("c", {{200, 0}, {300, 0}, {300, 100}})}),
              "handle 'c': the cage leaves the subject outside: no vertex of the mesh lies in it (draw it around the "
              "subject, or around a part of it)");
    EXPECT_EQ(refusal({cage_handle("c", {{-1e300, -1e300}, {1e300, -1e300}, {0, 1e300}})}),
              "handle 'c': the corner at (-1e+300, -1e+300) is too far away (stay within a million times the subject's "
              "size)");
    EXPECT_EQ(refusal({{"p", PointHandle{{50, 50}, {}}}}, WeightKind::mean_value),
              "weights 'mean-value': are a formula of one cage; the rig has other handles (use bbw, harmonic or, "
              "beside a cage, harmonic-cage)");
    EXPECT_EQ(refusal({cage_handle("c", frame), {"p", PointHandle{{50, 50}, {}}}}),
              "weights 'cauchy': are a formula of one cage; the rig has more handles than that (use bbw, harmonic or, "
              "beside a cage, harmonic-cage)");
}

}  // namespace puppetwarp
