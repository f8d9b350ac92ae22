// Skinning methods: what blends of handles' motions promise on a mesh.
#include "reference/test_meshes.h"
#include "support/message_of.h"

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/deform/skinning_motions.h>
#include <puppetwarp/rig/binding.h>

#include <gmock/gmock.h>
#include <Eigen/LU>

#include <cmath>
#include <numbers>
#include <random>

namespace puppetwarp {
namespace {

using reference::rig_of_points;
using testing::AllOf;
using testing::HasSubstr;
using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

MethodOptions options_of(Method method, WeightKind kind = WeightKind::harmonic) {
    MethodOptions options;
    options.method = method;
    options.weights.kind = kind;
    return options;
}

Deformation deformed(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig, const Pose& pose) {
    Progress progress;
    return make_deformer(options, mesh, rig)->deform(pose, nullptr, progress);
}

Weights weights_of(const TriangleMesh& mesh, const Rig& rig, WeightKind kind) {
    WeightOptions options;
    options.kind = kind;
    Progress progress;
    return compute_weights(mesh, rig, options, progress);
}

// Points, a chain of two bones and a region.
Rig mixed_rig() {
    Rig rig = rig_of_points({{330, 60}, {60, 330}});
    rig.handles.push_back({"upper", BoneHandle{{60, 60}, {140, 80}, ""}});
    rig.handles.push_back({"lower", BoneHandle{{140, 80}, {200, 150}, "upper"}});
    rig.handles.push_back({"region", RegionHandle{{{260, 250}, {330, 260}, {310, 330}, {250, 320}}, Falloff::none}});
    return rig;
}

TriangleMesh board(int n = 24) {
    return reference::grid(n, n, 400, 400, 0.2, 5);
}

std::array<double, 6> affine_of(const Eigen::Matrix2d& A, const Point& shift) {
    return {A(0, 0), A(1, 0), A(0, 1), A(1, 1), shift.x(), shift.y()};
}

class Skinning : public testing::TestWithParam<Method> {};

TEST_P(Skinning, RestIsRest) {
    for (const WeightKind kind : {WeightKind::shepard, WeightKind::harmonic, WeightKind::biharmonic}) {
        const TriangleMesh mesh = board();
        const Deformation result = deformed(options_of(GetParam(), kind), mesh, mixed_rig(), Pose());
        EXPECT_LT((result.V - mesh.V).cwiseAbs().maxCoeff(), 1e-12);
        EXPECT_EQ(result.energy, 0);
        EXPECT_TRUE(result.converged);
        EXPECT_TRUE(result.warnings.empty());
    }
}

TEST_P(Skinning, OneMotionOfAllHandlesMovesAll) {
    const TriangleMesh mesh = board();
    const Rig rig = mixed_rig();
    const Point centre(150, 90), shift(-37, 55);
    std::vector<Eigen::Matrix2d> maps(4);
    maps[0] = Eigen::Rotation2Dd(2.9).toRotationMatrix();
    maps[1] = 1.7 * maps[0];
    maps[2] << 1.2, 0.5, -0.3, 0.8;
    maps[3] << -0.9, -0.5, 0.6, -0.4;
    for (const Eigen::Matrix2d& A : maps) {
        Pose pose;
        for (const Handle& handle : rig.handles) pose.handles[handle.id].affine = affine_of(A, shift);
        const Deformation result = deformed(options_of(GetParam()), mesh, rig, pose);
        const Eigen::MatrixX2d expected = (mesh.V * A.transpose()).rowwise() + shift.transpose();
        EXPECT_LT((result.V - expected).cwiseAbs().maxCoeff(), 1e-10);
        EXPECT_LT(result.max_handle_error_px, 1e-10);
    }
    // The same by the words that each kind of handle has of its own.
    const double angle = 4.2;  // more than half a turn
    const auto map = [&](const Point& p) { return reference::rigid(p, centre, angle, shift); };
    Pose pose;
    for (const char* id : {"p0", "p1"}) {
        pose.handles[id].to = map(std::get<PointHandle>(find_handle(rig, id)->shape).at);
        pose.handles[id].rotate_rad = angle;
    }
    pose.handles["upper"].from = map({60, 60});
    pose.handles["upper"].rotate_rad = angle;
    const auto maps_now = column_motions(rig, pose, {{4, -1}}, mesh.V);
    const Complex region = maps_now[0].centre;
    pose.handles["region"].to = map({region.real(), region.imag()});
    pose.handles["region"].rotate_rad = angle;
    const Deformation result = deformed(options_of(GetParam()), mesh, rig, pose);
    for (int v = 0; v < mesh.V.rows(); ++v) {
        EXPECT_LT((result.V.row(v).transpose() - map(mesh.V.row(v).transpose())).norm(), 1e-10);
    }
}

// Moving a whole pose moves what came of it.
TEST_P(Skinning, FollowsAPoseThatIsMovedAsAWhole) {
    std::mt19937 engine(11);
    const auto between = [&](double low, double high) { return low + (high - low) * (engine() / 4294967296.0); };
    for (int round = 0; round < 5; ++round) {
        const TriangleMesh mesh = board(16);
        const Rig rig = mixed_rig();
        const double angle = between(-3, 3);
        const Complex turn = std::polar(1.0, angle), shift(between(-50, 50), between(-50, 50));
        Pose pose, moved;
        const auto motions = column_motions(rig, pose, {{0, -1}, {1, -1}, {2, -1}, {3, -1}, {4, -1}}, mesh.V);
        for (std::size_t h = 0; h < rig.handles.size(); ++h) {
            const double own = between(-1.2, 1.2), scale = between(0.6, 1.6);
            const Complex to = motions[h].centre + Complex(between(-40, 40), between(-40, 40));
            const AffineMap map{std::polar(scale, own), 0, to - std::polar(scale, own) * motions[h].centre};
            const auto entries = [](const AffineMap& m) {
                return std::array<double, 6>{m.alpha.real(), m.alpha.imag(), -m.alpha.imag(),
                                             m.alpha.real(), m.shift.real(), m.shift.imag()};
            };
            pose.handles[rig.handles[h].id].affine = entries(map);
            moved.handles[rig.handles[h].id].affine = entries({turn * map.alpha, 0, turn * map.shift + shift});
        }
        if (std::abs(angle) > 1.9) continue;  // an affine map does not say in which sense it turned
        const Eigen::VectorXcd x = complex_positions(deformed(options_of(GetParam()), mesh, rig, pose).V);
        const Eigen::VectorXcd y = complex_positions(deformed(options_of(GetParam()), mesh, rig, moved).V);
        EXPECT_LT((y - (turn * x.array() + shift).matrix()).cwiseAbs().maxCoeff(), 1e-9);
    }
}

TEST_P(Skinning, VerticesThatAHandleHoldsGoWithIt) {
    const TriangleMesh mesh = board();
    Rig rig = mixed_rig();
    rig.handles.push_back({"v", VertexHandle{300}});
    Pose pose;
    pose.handles["p0"].to = Point(350, 90);
    pose.handles["p0"].rotate_rad = 1;
    pose.handles["lower"].rotate_rad = -2;
    pose.handles["lower"].scale = 1.3;
    pose.handles["v"].to = Point(180, 210);
    const Deformation result = deformed(options_of(GetParam()), mesh, rig, pose);
    EXPECT_LT(result.max_handle_error_px, 1e-10);
    EXPECT_LT((result.V.row(300) - Eigen::RowVector2d(180, 210)).norm(), 1e-10);
    EXPECT_GT((result.V - mesh.V).rowwise().norm().maxCoeff(), 30);
    for (int v = 0; v < mesh.V.rows(); ++v) {
        const Point p = mesh.V.row(v).transpose();
        if (p.x() < 265 || p.x() > 300 || p.y() < 265 || p.y() > 310) continue;
        EXPECT_LT((result.V.row(v) - mesh.V.row(v)).norm(), 1e-10);  // in the region, which stays
    }
}

// The largest difference in place between neighbours.
double widest_edge(const TriangleMesh& mesh, const Eigen::MatrixX2d& x) {
    double widest = 0;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        for (int k = 0; k < 3; ++k) {
            widest = std::max(widest, (x.row(mesh.F(t, k)) - x.row(mesh.F(t, (k + 1) % 3))).norm());
        }
    }
    return widest;
}

const std::vector<Point> three_places{{80, 80}, {320, 100}, {190, 330}};
const std::vector<double> three_angles{0, 170 * pi / 180, -170 * pi / 180};

// Smooth, between 0 and 1, the same on every mesh.
Weights smooth_weights(const TriangleMesh& mesh) {
    Weights weights;
    weights.W.resize(mesh.V.rows(), 3);
    for (int j = 0; j < 3; ++j) {
        weights.columns.push_back({j, -1});
        const Eigen::RowVector2d place = three_places[static_cast<std::size_t>(j)].transpose();
        weights.W.col(j) = (-(mesh.V.rowwise() - place).rowwise().squaredNorm() / 50000).array().exp();
    }
    weights.W.array().colwise() /= weights.W.rowwise().sum().array().eval();
    return weights;
}

TEST_P(Skinning, IsContinuousForHandlesAt0And170AndMinus170Degrees) {
    Pose pose;
    for (std::size_t k = 0; k < 3; ++k) pose.handles["p" + std::to_string(k)].rotate_rad = three_angles[k];
    std::vector<double> jumps, torn;
    for (const int n : {60, 120, 240}) {
        const TriangleMesh mesh = reference::grid(n, n, 400, 400);
        const Rig rig = rig_of_points(three_places);
        const Weights weights = smooth_weights(mesh);
        Progress progress;
        const auto deformer = make_deformer(options_of(GetParam()), mesh, rig, weights);
        jumps.push_back(widest_edge(mesh, deformer->deform(pose, nullptr, progress).V));
        // What the test is to find: angles unwrapped anew at each vertex, against its heaviest handle.
        const Eigen::MatrixXd& W = weights.W;
        Eigen::MatrixX2d x(mesh.V.rows(), 2);
        for (int v = 0; v < mesh.V.rows(); ++v) {
            Eigen::Index heaviest = 0;
            W.row(v).maxCoeff(&heaviest);
            double angle = 0;
            for (int j = 0; j < 3; ++j) {
                const double reference = three_angles[static_cast<std::size_t>(heaviest)];
                angle += W(v, j) *
                         (reference + std::remainder(three_angles[static_cast<std::size_t>(j)] - reference, 2 * pi));
            }
            x.row(v) = reference::rigid(mesh.V.row(v).transpose(), {200, 200}, angle, {0, 0}).transpose();
        }
        torn.push_back(widest_edge(mesh, x));
    }
    for (const std::size_t i : {0u, 1u}) {
        EXPECT_LT(jumps[i + 1], 0.6 * jumps[i]);
        EXPECT_GT(torn[i + 1], 0.9 * torn[i]);
    }
}

TEST_P(Skinning, RefusesMapsThatMirrorOrFlattenUnlessLinear) {
    const TriangleMesh mesh = board(8);
    const Rig rig = rig_of_points({{80, 80}, {300, 300}});
    Eigen::Matrix2d mirror, flat;
    mirror << -1, 0, 0, 1;
    flat << 1, 2, 2, 4;
    for (const Eigen::Matrix2d& A : {mirror, flat}) {
        Pose pose;
        pose.handles["p1"].affine = affine_of(A, {0, 0});
        const std::string message = message_of([&] { deformed(options_of(GetParam()), mesh, rig, pose); });
        if (GetParam() == Method::lbs) {
            EXPECT_EQ(message, "");
        } else {
            EXPECT_EQ(message, "handle 'p1': '" + method_name(GetParam()) +
                                   "' cannot blend a map that mirrors or flattens (use the method lbs)");
        }
    }
}

TEST_P(Skinning, TellsWhatTheWeightsTell) {
    const TriangleMesh mesh = reference::joined(board(8), reference::grid(4, 4, 40, 40), {500, 100});
    const Rig rig = rig_of_points({{80, 80}, {400, 100}});
    Pose pose;
    pose.handles["p1"].to = Point(430, 120);
    const Deformation loose = deformed(options_of(GetParam()), mesh, rig, pose);
    ASSERT_EQ(loose.warnings.size(), 1u);
    EXPECT_THAT(loose.warnings[0], AllOf(HasSubstr("no handle"), HasSubstr("'p1'")));
    const Eigen::MatrixX2d expected = mesh.V.bottomRows(25).rowwise() + Eigen::RowVector2d(30, 20);
    EXPECT_LT((loose.V.bottomRows(25) - expected).cwiseAbs().maxCoeff(), 1e-12);

    Weights weights = weights_of(mesh, rig, WeightKind::harmonic);
    weights.warnings.clear();
    weights.converged = false;
    weights.fallback = "projected Newton";
    Progress progress;
    const Deformation unsolved =
        make_deformer(options_of(GetParam()), mesh, rig, weights)->deform(pose, nullptr, progress);
    EXPECT_THAT(unsolved.warnings, testing::ElementsAre(HasSubstr("projected Newton"), HasSubstr("did not converge")));
}

TEST_P(Skinning, TakesWeightsThatAreReadyButNotOthers) {
    const TriangleMesh mesh = board(10);
    const Rig rig = mixed_rig();
    Pose pose;
    pose.handles["p0"].to = Point(300, 90);
    const Weights weights = weights_of(mesh, rig, WeightKind::harmonic);
    Progress progress;
    const auto ready = make_deformer(options_of(GetParam()), mesh, rig, weights);
    EXPECT_EQ(ready->deform(pose, nullptr, progress).V, deformed(options_of(GetParam()), mesh, rig, pose).V);
    const auto refusal = [&](const Rig& other, const Weights& unfit) {
        return message_of([&] { make_deformer(options_of(GetParam()), mesh, other, unfit); });
    };
    EXPECT_EQ(refusal(rig_of_points({{200, 200}}), weights),
              "weights: they are not of this mesh and these handles (compute them anew)");
    Weights broken = weights;
    broken.W(3, 1) = std::nan("");
    EXPECT_EQ(refusal(rig, broken), "weights: not all of them are finite (compute them anew)");
}

TEST_P(Skinning, CanBeCancelledWhileWeightsAreComputed) {
    class Impatient : public Progress {
    public:
        bool cancelled() const override { return true; }
    };
    Impatient progress;
    EXPECT_THROW(make_deformer(options_of(GetParam()), board(8), mixed_rig(), progress), Cancelled);
}

// A cage's corners carry by complex weights: W + i W_imaginary.
TEST_P(Skinning, ComplexWeightsOfACageCarryToo) {
    const TriangleMesh mesh = reference::grid(1, 1, 10, 10);
    Rig rig;
    rig.handles.push_back({"hull", CageHandle{{{-1, -1}, {11, -1}, {5, 20}}}});
    Weights weights;
    weights.columns = {{0, 0}, {0, 1}, {0, 2}};
    weights.W.resize(4, 3);
    weights.W << 0.5, 0.3, 0.2, 0.1, 0.7, 0.2, 0.3, 0.3, 0.4, 0.2, 0.4, 0.4;
    weights.W_imaginary.resize(4, 3);
    weights.W_imaginary << 0.1, -0.3, 0.2, 0, 0.2, -0.2, 0.1, 0.1, -0.2, -0.4, 0.1, 0.3;
    Pose pose;
    pose.handles["hull"].points = Polyline{{2, -1}, {13, 4}, {5, 26}};
    const Eigen::Vector3cd moves(Complex(3, 0), Complex(2, 5), Complex(0, 6));
    Progress progress;
    const Deformation result =
        make_deformer(options_of(GetParam()), mesh, rig, weights)->deform(pose, nullptr, progress);
    const Eigen::VectorXcd x = complex_positions(result.V);
    for (int v = 0; v < 4; ++v) {
        Complex expected(mesh.V(v, 0), mesh.V(v, 1));
        for (int j = 0; j < 3; ++j) expected += Complex(weights.W(v, j), weights.W_imaginary(v, j)) * moves(j);
        EXPECT_LT(std::abs(x(v) - expected), 1e-12);
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, Skinning, testing::Values(Method::lbs, Method::dual_complex, Method::intrinsic),
                         [](const auto& each) {
                             std::string name = method_name(each.param);
                             std::erase(name, '-');
                             return name;
                         });

// p' = sum of w_j T_j p, T_j 2 x 3: each handle with an affine map of its own.
TEST(LinearBlendSkinning, IsTheWeightedSumOfAffineMapsOfPointsBonesAndRegions) {
    std::mt19937 engine(23);
    const auto between = [&](double low, double high) { return low + (high - low) * (engine() / 4294967296.0); };
    const TriangleMesh mesh = board();
    const Rig rig = mixed_rig();
    for (const WeightKind kind : {WeightKind::bbw, WeightKind::harmonic}) {
        Pose pose;
        std::vector<Eigen::Matrix<double, 2, 3>> T(rig.handles.size());
        for (std::size_t h = 0; h < rig.handles.size(); ++h) {
            std::array<double, 6> entries{};
            for (std::size_t k = 0; k < 4; ++k) entries[k] = between(-1.5, 1.5);
            for (std::size_t k = 4; k < 6; ++k) entries[k] = between(-80, 80);
            // x' = a x + c y + e, y' = b x + d y + f
            T[h] << entries[0], entries[2], entries[4], entries[1], entries[3], entries[5];
            pose.handles[rig.handles[h].id].affine = entries;
        }
        const Weights weights = weights_of(mesh, rig, kind);
        const Eigen::MatrixX2d V = deformed(options_of(Method::lbs, kind), mesh, rig, pose).V;
        for (Eigen::Index v = 0; v < V.rows(); ++v) {
            const Eigen::Vector3d p(mesh.V(v, 0), mesh.V(v, 1), 1);
            Eigen::Vector2d expected = Eigen::Vector2d::Zero();
            for (std::size_t h = 0; h < T.size(); ++h) {
                expected += weights.W(v, static_cast<Eigen::Index>(h)) * (T[h] * p);
            }
            EXPECT_LT((V.row(v).transpose() - expected).norm(), 1e-10);
        }
    }
}

TEST(SkinningMotions, AnglesAddUpAlongABonesChain) {
    Rig rig;
    rig.handles.push_back({"c", BoneHandle{{200, 0}, {300, 0}, "b"}});
    rig.handles.push_back({"a", BoneHandle{{0, 0}, {100, 0}, ""}});
    rig.handles.push_back({"b", BoneHandle{{100, 0}, {200, 0}, "a"}});
    const double angle = 2 * pi / 3;
    Pose pose;
    for (const char* id : {"a", "b", "c"}) pose.handles[id].rotate_rad = angle;
    const TriangleMesh mesh = reference::grid(30, 4, 300, 40);
    const auto motions = column_motions(rig, pose, {{0, -1}, {1, -1}, {2, -1}}, mesh.V);
    EXPECT_NEAR(motions[0].angle_rad, 3 * angle, 1e-12);
    EXPECT_NEAR(motions[1].angle_rad, angle, 1e-12);
    EXPECT_NEAR(motions[2].angle_rad, 2 * angle, 1e-12);
    // Three sides of a triangle: the chain's end comes back to its start.
    EXPECT_LT(std::abs(motions[0].map(Complex(300, 0))), 1e-10);
}

// Round the clock: joints stay as wide as they are, although the last bone ends up as it started.
TEST(SkinningMotions, AWoundUpChainKeepsItsWidth) {
    const TriangleMesh mesh = reference::grid(120, 8, 300, 20);
    Rig rig;
    rig.handles.push_back({"a", BoneHandle{{0, 10}, {100, 10}, ""}});
    rig.handles.push_back({"b", BoneHandle{{100, 10}, {200, 10}, "a"}});
    rig.handles.push_back({"c", BoneHandle{{200, 10}, {300, 10}, "b"}});
    Pose pose;
    for (const char* id : {"a", "b", "c"}) pose.handles[id].rotate_rad = 2 * pi / 3;
    const auto narrowest = [&](Method method) {
        const Deformation result = deformed(options_of(method), mesh, rig, pose);
        double least = 20;
        for (int i = 0; i <= 120; ++i) least = std::min(least, (result.V.row(8 * 121 + i) - result.V.row(i)).norm());
        return least;
    };
    EXPECT_LT(narrowest(Method::lbs), 13);
    EXPECT_GT(narrowest(Method::dual_complex), 17);
    EXPECT_GT(narrowest(Method::intrinsic), 17);
}

TEST(SkinningMotions, RefusesTargetsThatAreTooFar) {
    Pose pose;
    pose.handles["p0"].to = Point(1e12, 0);
    EXPECT_THAT(message_of([&] { deformed(options_of(Method::lbs), board(8), mixed_rig(), pose); }),
                AllOf(HasSubstr("'p0'"), HasSubstr("too far")));
}

TEST(SkinningMotions, TurnsAWholeTurnApartAreNamed) {
    Pose pose;
    pose.handles["p1"].rotate_rad = 2 * pi;
    for (const Method method : {Method::dual_complex, Method::intrinsic}) {
        const Deformation result = deformed(options_of(method), board(), rig_of_points({{80, 80}, {300, 300}}), pose);
        ASSERT_EQ(result.warnings.size(), 1u);
        EXPECT_THAT(result.warnings[0], AllOf(HasSubstr("whole turn"), HasSubstr(method_name(method))));
        EXPECT_TRUE(result.V.allFinite());
    }
}

}  // namespace
}  // namespace puppetwarp
