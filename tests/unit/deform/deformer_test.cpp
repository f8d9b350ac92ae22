// What every method promises.
#include "reference/test_meshes.h"
#include "support/message_of.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/deform/deformer.h>

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <thread>

namespace puppetwarp {
namespace {

using reference::rig_of_points;
using reference::rig_of_vertices;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsSupersetOf;
namespace places = reference::figure_places;

Rig figure_rig(double size) {
    return rig_of_points({size * places::head, size * places::left_hand, size * places::right_hand,
                          size * places::left_foot, size * places::right_foot});
}

Pose figure_pose(double size) {
    Pose pose;
    pose.name = "wave";
    pose.handles["p1"].to = size * (places::left_hand + Point(0.1, -0.05));
    pose.handles["p4"].to = size * (places::right_foot + Point(0.08, -0.1));
    return pose;
}

std::string name_of(const testing::TestParamInfo<std::string>& each) {
    std::string name = each.param;
    std::erase(name, '-');
    return name;
}

class EveryMethod : public testing::TestWithParam<std::string> {
protected:
    MethodOptions options() const {
        MethodOptions options;
        if (GetParam().starts_with("arap")) {
            options.arap_energy =
                GetParam() == "arap" ? ArapEnergy::elements : arap_energy_from_name(GetParam().substr(5));
        } else {
            options.method = method_from_name(GetParam());
        }
        options.weights.kind = WeightKind::harmonic;
        return options;
    }
    // Moving least squares are a field over the plane: no triangle limits it.
    bool knows_the_shape() const { return !GetParam().starts_with("mls"); }
    // Weights decide what follows a handle, and refuse two for one vertex.
    bool is_skinning() const { return uses_weights(options().method); }
    std::unique_ptr<Deformer> deformer(const TriangleMesh& mesh, const Rig& rig) const {
        return make_deformer(options(), mesh, rig);
    }
    Deformation deformed(const TriangleMesh& mesh, const Rig& rig, const Pose& pose) const {
        Progress progress;
        return deformer(mesh, rig)->deform(pose, nullptr, progress);
    }
};

TEST_P(EveryMethod, RestStaysAtRest) {
    for (const std::uint32_t seed : {1u, 2u}) {
        const TriangleMesh mesh = reference::blob(900, 30, seed);
        const Deformation result = deformed(mesh, rig_of_points({{450, 450}, {380, 420}, {500, 350}}), Pose());
        EXPECT_LT((result.V - mesh.V).cwiseAbs().maxCoeff(), 1e-12 * 900);
        EXPECT_TRUE(result.converged);
        EXPECT_LT(result.energy, 1e-18);
    }
}

TEST_P(EveryMethod, MovingAllHandlesMovesEverything) {
    const TriangleMesh mesh = reference::figure(500, 14);
    const Rig rig = figure_rig(500);
    Pose pose;
    for (const Handle& handle : rig.handles) {
        pose.handles[handle.id].to = std::get<PointHandle>(handle.shape).at + Point(211.5, -37.25);
    }
    const Deformation result = deformed(mesh, rig, pose);
    const Eigen::MatrixX2d expected = mesh.V.rowwise() + Eigen::RowVector2d(211.5, -37.25);
    EXPECT_LT((result.V - expected).cwiseAbs().maxCoeff(), 1e-12 * 800);
}

TEST_P(EveryMethod, APartWithoutHandlesStaysAndIsNamed) {
    if (is_skinning()) return;
    const TriangleMesh figure = reference::figure(500, 14);
    const TriangleMesh mesh = reference::joined(figure, reference::grid(4, 4, 60, 60), Point(520, 100));
    const Deformation alone = deformed(figure, figure_rig(500), figure_pose(500));
    EXPECT_TRUE(alone.warnings.empty());
    Progress progress;
    const auto shared = deformer(mesh, figure_rig(500));
    const Deformation first = shared->deform(figure_pose(500), nullptr, progress);
    // A start that has it elsewhere does not lead it astray.
    const Eigen::MatrixX2d astray = first.V.array() + 7;
    for (const Deformation& result : {first, shared->deform(figure_pose(500), &astray, progress)}) {
        const Eigen::Index loose = mesh.V.rows() - figure.V.rows();
        EXPECT_EQ(result.V.bottomRows(loose), mesh.V.bottomRows(loose));
        ASSERT_EQ(result.warnings.size(), 1u);
        EXPECT_THAT(result.warnings[0], AllOf(HasSubstr("no handle"), HasSubstr("(550, 130)")));
    }
}

TEST_P(EveryMethod, MeetsItsHandles) {
    const TriangleMesh mesh = reference::figure(500, 10);
    Rig rig = figure_rig(500);
    rig.handles.push_back({"v", VertexHandle{100}});
    Pose pose = figure_pose(500);
    const Point to = mesh.V.row(100).transpose() + Point(3, -2);
    pose.handles["v"].to = to;
    const Deformation result = deformed(mesh, rig, pose);
    // Springs of fold-free are strong, but springs.
    const double near = GetParam() == "fold-free" ? 0.02 : 1e-8;
    EXPECT_LT(result.max_handle_error_px, near);
    EXPECT_LT((result.V.row(100).transpose() - to).norm(), near);
    EXPECT_TRUE(result.V.allFinite());
}

TEST_P(EveryMethod, MirroredInputGivesMirroredOutput) {
    const TriangleMesh mesh = reference::figure(500, 16);
    TriangleMesh mirrored = mesh;
    mirrored.V.col(0) = 500 - mesh.V.col(0).array();  // clockwise now, and keeps its indices
    const auto mirror = [](const Point& p) { return Point(500 - p.x(), p.y()); };
    const Rig rig = figure_rig(500);
    Rig mirrored_rig = rig;
    for (Handle& handle : mirrored_rig.handles) {
        Point& at = std::get<PointHandle>(handle.shape).at;
        at = mirror(at);
    }
    Pose pose = figure_pose(500);
    pose.handles["p0"].rotate_rad = 0.4;
    Pose mirrored_pose = pose;
    for (auto& [id, target] : mirrored_pose.handles) {
        if (target.to) target.to = mirror(*target.to);
        if (target.rotate_rad) target.rotate_rad = -*target.rotate_rad;
    }
    Eigen::MatrixX2d back = deformed(mirrored, mirrored_rig, mirrored_pose).V;
    back.col(0) = 500 - back.col(0).array();
    EXPECT_LT((back - deformed(mesh, rig, pose).V).cwiseAbs().maxCoeff(), 1e-6);
}

TEST_P(EveryMethod, KnowsNoAbsoluteLength) {
    const TriangleMesh mesh = reference::figure(1, 0.03);
    const Deformation unit = deformed(mesh, figure_rig(1), figure_pose(1));
    for (const double size : {1e-3, 4000.0}) {
        TriangleMesh scaled = mesh;
        scaled.V *= size;
        const Deformation result = deformed(scaled, figure_rig(size), figure_pose(size));
        EXPECT_LT((result.V / size - unit.V).cwiseAbs().maxCoeff(), 1e-6);
        EXPECT_EQ(result.converged, unit.converged);
    }
}

TEST_P(EveryMethod, SameBytesEveryTimeAndFromEveryThread) {
    const TriangleMesh mesh = reference::figure(500, 16);
    const auto shared = deformer(mesh, figure_rig(500));
    const Pose pose = figure_pose(500);
    Progress progress;
    const Eigen::MatrixX2d first = shared->deform(pose, nullptr, progress).V;
    std::vector<Eigen::MatrixX2d> results(4);
    std::vector<std::thread> threads;
    for (Eigen::MatrixX2d& result : results) {
        threads.emplace_back([&] {
            Progress own;
            result = shared->deform(pose, nullptr, own).V;
        });
    }
    for (std::thread& thread : threads) thread.join();
    for (const Eigen::MatrixX2d& result : results) EXPECT_EQ(result, first);
    EXPECT_EQ(deformed(mesh, figure_rig(500), pose).V, first);
}

TEST_P(EveryMethod, TwoHandlesInOnePlaceCountAsOne) {
    if (is_skinning()) return;
    const TriangleMesh mesh = reference::figure(500, 14);
    const Pose pose = figure_pose(500);
    const Deformation one = deformed(mesh, figure_rig(500), pose);
    Rig rig = figure_rig(500);
    rig.handles.push_back({"again", PointHandle{500 * places::left_hand, {}}});
    Pose both = pose;
    both.handles["again"] = pose.handles.at("p1");
    EXPECT_LT((deformed(mesh, rig, both).V - one.V).cwiseAbs().maxCoeff(), 1e-3);
    EXPECT_THAT(message_of([&] { deformed(mesh, rig, pose); }),
                AllOf(HasSubstr("'p1' and 'again'"), HasSubstr("one place")));
}

TEST_P(EveryMethod, MoreConstraintsThanATriangleCanMeetAreRefused) {
    if (!knows_the_shape() || is_skinning()) return;
    if (GetParam() == "fold-free") return;  // its springs meet in the middle
    const TriangleMesh mesh = reference::grid(1, 1, 100, 100);
    const Rig rig = rig_of_points({{20, 5}, {30, 5}, {60, 20}, {70, 10}, {40, 10}});
    Pose pose;
    pose.handles["p3"].to = Point(90, 40);
    EXPECT_THAT(message_of([&] { deformed(mesh, rig, pose); }), HasSubstr("cannot be met together"));
    pose.handles.clear();
    EXPECT_EQ(message_of([&] { deformed(mesh, rig, pose); }), "");
}

TEST_P(EveryMethod, RefusesWhatItCannotDo) {
    const TriangleMesh mesh = reference::grid(8, 8, 100, 100);
    EXPECT_THAT(message_of([&] { deformer(mesh, Rig()); }), HasSubstr("no handles"));
    EXPECT_THAT(message_of([&] { deformer(mesh, rig_of_points({{110, 50}})); }), HasSubstr("lies 10 px outside"));
    Pose pose;
    pose.handles["ghost"];
    EXPECT_THAT(message_of([&] { deformed(mesh, rig_of_points({{50, 50}}), pose); }), HasSubstr("'ghost'"));
    TriangleMesh bad = mesh;
    bad.V(3, 0) = std::numeric_limits<double>::infinity();
    EXPECT_THAT(message_of([&] { deformer(bad, rig_of_points({{50, 50}})); }), HasSubstr("vertex 3"));
}

TEST_P(EveryMethod, CanBeCancelled) {
    class Impatient : public Progress {
    public:
        bool cancelled() const override { return true; }
    };
    const TriangleMesh mesh = reference::figure(500, 16);
    Impatient progress;
    EXPECT_THROW(deformer(mesh, figure_rig(500))->deform(figure_pose(500), nullptr, progress), Cancelled);
}

TEST_P(EveryMethod, AVertexOfNoTriangleStaysOrIsHeld) {
    if (!knows_the_shape() || is_skinning()) return;
    TriangleMesh mesh = reference::grid(6, 6, 60, 60, 0.2);
    mesh.V.conservativeResize(mesh.V.rows() + 2, 2);
    mesh.V.bottomRows(2) << 80, 80, 90, 10;
    Rig rig = rig_of_points({{10, 10}, {50, 50}});
    rig.handles.push_back({"lone", VertexHandle{static_cast<int>(mesh.V.rows()) - 1}});
    Pose pose;
    for (const char* id : {"p0", "p1"})
        pose.handles[id].to = std::get<PointHandle>(find_handle(rig, id)->shape).at + Point(5, 6);
    pose.handles["lone"].to = Point(95, 16);
    const Deformation result = deformed(mesh, rig, pose);
    Eigen::MatrixX2d expected = mesh.V.rowwise() + Eigen::RowVector2d(5, 6);
    expected.row(mesh.V.rows() - 2) = mesh.V.row(mesh.V.rows() - 2);
    EXPECT_LT((result.V - expected).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_TRUE(result.warnings.empty());  // it shows nothing
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryMethod,
                         testing::Values("harmonic", "biharmonic", "triharmonic", "tetraharmonic", "thin-shell", "arap",
                                         "arap-spokes", "arap-spokes-and-rims", "smooth-arap", "fold-free"),
                         name_of);

INSTANTIATE_TEST_SUITE_P(DifferentialCoordinates, EveryMethod,
                         testing::Values("laplacian", "laplacian-rotated", "laplacian-similarity", "multiresolution"),
                         name_of);
INSTANTIATE_TEST_SUITE_P(MovingLeastSquares, EveryMethod, testing::Values("mls-affine", "mls-similarity", "mls-rigid"),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Skinning, EveryMethod, testing::Values("fast", "lbs", "dual-complex", "intrinsic"), name_of);

TEST(MethodNames, GoBothWays) {
    EXPECT_EQ(method_names(),
              (std::vector<std::string>{"harmonic", "biharmonic", "triharmonic", "tetraharmonic", "thin-shell",
                                        "laplacian", "laplacian-rotated", "laplacian-similarity", "multiresolution",
                                        "arap", "smooth-arap", "fold-free", "fast", "lbs", "dual-complex", "intrinsic",
                                        "mls-affine", "mls-similarity", "mls-rigid"}));
    for (const std::string& name : method_names()) EXPECT_EQ(method_name(method_from_name(name)), name);
    for (const char* name : {"elements", "spokes", "spokes-and-rims"}) {
        EXPECT_EQ(arap_energy_name(arap_energy_from_name(name)), name);
    }
    EXPECT_THAT(message_of([] { method_from_name("magic"); }), AllOf(HasSubstr("'magic'"), HasSubstr("biharmonic")));
}

TEST(MakeDeformer, ChecksItsOptions) {
    const TriangleMesh mesh = reference::grid(4, 4, 10, 10);
    const Rig rig = rig_of_points({{5, 5}});
    MethodOptions options;
    options.tolerance = 0;
    EXPECT_THAT(message_of([&] { make_deformer(options, mesh, rig); }), HasSubstr("tolerance"));
    options = {};
    options.max_iterations = 0;
    EXPECT_THAT(message_of([&] { make_deformer(options, mesh, rig); }), HasSubstr("max_iterations"));
}

}  // namespace
}  // namespace puppetwarp
