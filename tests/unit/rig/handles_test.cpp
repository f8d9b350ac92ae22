// What bones, regions, vertices and affine points hold of a mesh, and where a pose sends it.
#include "reference/test_meshes.h"
#include "support/message_of.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/rig/binding.h>

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace puppetwarp {
namespace {

using reference::rig_of_points;
using reference::rig_of_vertices;
using testing::AllOf;
using testing::HasSubstr;
using Complex = std::complex<double>;

Complex complex_of(const Point& p) {
    return {p.x(), p.y()};
}

Targets resolved(const TriangleMesh& mesh, const Rig& rig, const Pose& pose, AffineUse affine = AffineUse::yes) {
    return resolve(take_hold(mesh, rig, "test"), mesh, rig, pose, affine, "test");
}

Polyline box(double left, double top, double right, double bottom) {
    return {{left, top}, {right, top}, {right, bottom}, {left, bottom}};
}

Rig rig_of(const std::string& id, const decltype(Handle::shape)& shape) {
    Rig rig;
    rig.handles.push_back({id, shape});
    return rig;
}

const std::array<double, 6> sheared{1.25, 0.5, -0.25, 0.75, 8, -5};

// `sheared`, entry by entry.
Complex shear(const Complex& z) {
    return {1.25 * z.real() - 0.25 * z.imag() + 8, 0.5 * z.real() + 0.75 * z.imag() - 5};
}

Eigen::VectorXcd mapped(const TriangleMesh& mesh, const std::function<Complex(Complex)>& map) {
    return complex_positions(mesh.V).unaryExpr(map);
}

// How far the holds are from where the targets want them when the whole mesh moves by `map`.
double largest_miss(const TriangleMesh& mesh, const Rig& rig, const Pose& pose,
                    const std::function<Complex(Complex)>& map) {
    const Binding binding = take_hold(mesh, rig, "test");
    const Targets targets = resolve(binding, mesh, rig, pose, AffineUse::yes, "test");
    const Eigen::VectorXcd rest = complex_positions(mesh.V), moved = mapped(mesh, map);
    double miss = 0;
    for (std::size_t h = 0; h < binding.holds.size(); ++h) {
        const Hold& hold = binding.holds[h];
        const HoldTarget& target = targets.holds[h];
        const Complex move = row_value(hold.mean, moved) - row_value(hold.mean, rest);
        miss = std::max(miss, std::abs(move - target.move));
        if (hold.turn.empty()) continue;
        const Complex turn = row_value(hold.turn, moved);
        if (target.rotate_rad)
            miss = std::max(miss, std::abs(turn / std::abs(turn) - std::polar(1.0, *target.rotate_rad)));
        if (target.scale) miss = std::max(miss, std::abs(std::abs(turn) - *target.scale));
        if (target.shear) miss = std::max(miss, std::abs(row_value(hold.shear, moved) - *target.shear));
    }
    for (std::size_t i = 0; i < binding.vertices.size(); ++i) {
        const auto index = static_cast<Eigen::Index>(i);
        miss = std::max(miss, std::abs(moved(binding.vertices[i].vertex) - targets.vertices(index)));
    }
    return miss;
}

TEST(Bone, IsHeldByDiscsAlongItself) {
    const TriangleMesh mesh = reference::grid(60, 60, 100, 100, 0.25);
    const BoneHandle bone{{20, 30}, {70, 60}, ""};
    const Binding binding = take_hold(mesh, rig_of("arm", bone), "test");
    const Eigen::VectorXcd rest = complex_positions(mesh.V);
    const Complex from = complex_of(bone.from), along = complex_of(bone.to) - from;
    EXPECT_LT(std::abs(binding.holds.front().at - from), 1e-12);
    EXPECT_LT(std::abs(binding.holds.back().at - from - along), 1e-12);
    for (std::size_t h = 0; h < binding.holds.size(); ++h) {
        const Hold& hold = binding.holds[h];
        EXPECT_NEAR(((hold.at - from) / along).imag(), 0, 1e-12);
        EXPECT_LT(std::abs(row_value(hold.mean, rest) - hold.at), 1e-12);
        EXPECT_TRUE(hold.turn.empty() && hold.shear.empty());
        const Complex before = binding.holds[h == 0 ? 0 : h - 1].at;
        EXPECT_LE(std::abs(hold.at - before), hold.radius_px);
    }
    EXPECT_TRUE(binding.vertices.empty());
}

TEST(Bone, TakesHoldWhereThereIsASubjectBetweenItsEnds) {
    const auto ring = [](double x, double y) {
        const double r = std::hypot(x - 50, y - 50);
        return r > 20 && r < 50;
    };
    const TriangleMesh mesh = reference::shape(ring, 100, 2);
    const Binding binding = take_hold(mesh, rig_of("across", BoneHandle{{10, 50}, {90, 50}, ""}), "test");
    EXPECT_GE(binding.holds.size(), 10u);
    for (const Hold& hold : binding.holds) EXPECT_GT(std::abs(hold.at - Complex(50, 50)), 17);
}

TEST(Bone, OnACoarseMeshOneHoldATriangleIsEnough) {
    const TriangleMesh mesh = reference::grid(1, 1, 100, 100);
    const Binding binding = take_hold(mesh, rig_of("arm", BoneHandle{{10, 20}, {90, 30}, ""}), "test");
    EXPECT_LE(binding.holds.size(), 3u);
    EXPECT_GE(binding.holds.size(), 2u);
}

TEST(Bone, AJointIsHeldOnceAndMustNotBreak) {
    const TriangleMesh mesh = reference::grid(60, 60, 100, 100, 0.25);
    Rig rig = rig_of("upper", BoneHandle{{20, 50}, {50, 50}, ""});
    rig.handles.push_back({"lower", BoneHandle{{50, 50}, {80, 50}, "upper"}});
    const Binding binding = take_hold(mesh, rig, "test");
    const auto at_joint = [](const Hold& hold) { return std::abs(hold.at - Complex(50, 50)) < 1; };
    EXPECT_EQ(std::count_if(binding.holds.begin(), binding.holds.end(), at_joint), 1);
    Pose pose;
    pose.handles["upper"].rotate_rad = 0.5;
    pose.handles["lower"].rotate_rad = -1.5;
    EXPECT_EQ(message_of([&] { resolved(mesh, rig, pose); }), "");
    pose.handles["lower"] = {};
    pose.handles["lower"].from = Point(60, 50);
    EXPECT_THAT(message_of([&] { resolved(mesh, rig, pose); }),
                AllOf(HasSubstr("'upper' and 'lower'"), HasSubstr("one place")));
}

TEST(Bone, APointOnItSharesTheHoldAndKeepsItsTurn) {
    const TriangleMesh mesh = reference::grid(60, 60, 100, 100, 0.25);
    Rig rig = rig_of("arm", BoneHandle{{20, 50}, {50, 50}, ""});
    rig.handles.push_back({"tip", PointHandle{{50, 50}, {}}});
    const Binding binding = take_hold(mesh, rig, "test");
    Pose pose;
    pose.handles["tip"].to = Point(50, 60);
    EXPECT_THAT(message_of([&] { resolved(mesh, rig, pose); }),
                AllOf(HasSubstr("'arm' and 'tip'"), HasSubstr("one place")));
    pose.handles["arm"].to = Point(50, 60);
    pose.handles["tip"].rotate_rad = 1;
    const Targets targets = resolved(mesh, rig, pose);
    int turned = 0;
    for (std::size_t h = 0; h < binding.holds.size(); ++h) {
        if (binding.holds[h].turn.empty()) continue;
        ++turned;
        EXPECT_EQ(targets.holds[h].rotate_rad, 1);
        EXPECT_LT(std::abs(targets.holds[h].move - Complex(0, 10)), 1e-9);
    }
    EXPECT_EQ(turned, 1);
}

TEST(Region, HoldsTheVerticesInsideAndNoOthers) {
    const TriangleMesh mesh = reference::grid(40, 40, 100, 100, 0.25);
    const Point a(20, 10), b(80, 40), c(30, 90);
    const Binding binding = take_hold(mesh, rig_of("torso", RegionHandle{{a, b, c}}), "test");
    // Left of all three edges or right of all.
    const auto side = [](const Point& p, const Point& q, const Point& r) {
        return (q.x() - p.x()) * (r.y() - p.y()) - (q.y() - p.y()) * (r.x() - p.x()) > 0;
    };
    std::vector<int> expected;
    for (int v = 0; v < mesh.V.rows(); ++v) {
        const Point p = mesh.V.row(v).transpose();
        if (side(a, b, p) == side(b, c, p) && side(b, c, p) == side(c, a, p)) expected.push_back(v);
    }
    std::vector<int> held;
    for (const HeldVertex& each : binding.vertices) held.push_back(each.vertex);
    EXPECT_EQ(held, expected);
    EXPECT_GT(held.size(), 300u);
}

TEST(Region, TurnsAndGrowsAboutItsCentroidWhichGoesToTo) {
    const TriangleMesh mesh = reference::grid(40, 40, 100, 100, 0.25);
    const Rig rig = rig_of("torso", RegionHandle{box(20, 30, 60, 50)});
    Pose pose;
    pose.handles["torso"].rotate_rad = 0.7;
    const Complex centre(40, 40);
    const auto turn = [&](Complex z) { return centre + std::polar(1.0, 0.7) * (z - centre); };
    EXPECT_LT(largest_miss(mesh, rig, pose, turn), 1e-12);
    pose.handles["torso"].scale = 1.5;
    pose.handles["torso"].to = Point(55, 20);
    const auto all = [&](Complex z) { return Complex(55, 20) + std::polar(1.5, 0.7) * (z - centre); };
    EXPECT_LT(largest_miss(mesh, rig, pose, all), 1e-12);
    EXPECT_GT(largest_miss(mesh, rig, pose, turn), 1);
}

TEST(Region, OverlappingOnesMustAgree) {
    const TriangleMesh mesh = reference::grid(40, 40, 100, 100);
    Rig rig = rig_of("chest", RegionHandle{box(20, 20, 60, 60)});
    rig.handles.push_back({"belly", RegionHandle{box(20, 41, 60, 81)}});
    rig.handles.push_back({"v", VertexHandle{reference::nearest_vertex(mesh, {50, 50})}});
    const Binding binding = take_hold(mesh, rig, "test");
    for (std::size_t i = 1; i < binding.vertices.size(); ++i) {
        EXPECT_LT(binding.vertices[i - 1].vertex, binding.vertices[i].vertex);
    }
    Pose pose;
    EXPECT_EQ(message_of([&] { resolved(mesh, rig, pose); }), "");
    pose.handles["chest"].affine = pose.handles["belly"].affine = sheared;
    const Complex v = complex_of(mesh.V.row(reference::nearest_vertex(mesh, {50, 50})).transpose());
    pose.handles["v"].to = Point(shear(v).real(), shear(v).imag());
    EXPECT_EQ(message_of([&] { resolved(mesh, rig, pose); }), "");
    EXPECT_LT(largest_miss(mesh, rig, pose, shear), 1e-12);
    const char* const disagree = "they hold one vertex but are sent to different places";
    pose.handles["v"].to = Point(51, 50);
    EXPECT_THAT(message_of([&] { resolved(mesh, rig, pose); }),
                AllOf(HasSubstr("'chest' and 'v'"), HasSubstr(disagree)));
    pose.handles.erase("belly");
    EXPECT_THAT(message_of([&] { resolved(mesh, rig, pose); }), HasSubstr(disagree));
}

TEST(Vertex, TwoHandlesOfOneMustAgree) {
    const TriangleMesh mesh = reference::grid(10, 10, 100, 100);
    const Rig rig = rig_of_vertices({7, 12, 7});
    EXPECT_EQ(take_hold(mesh, rig, "test").vertices.size(), 2u);
    Pose pose;
    pose.handles["v2"].to = Point(1, 2);
    EXPECT_THAT(message_of([&] { resolved(mesh, rig, pose); }),
                AllOf(HasSubstr("'v0' and 'v2'"), HasSubstr("one vertex")));
    pose.handles["v0"].to = Point(1, 2);
    const Targets targets = resolved(mesh, rig, pose);
    EXPECT_EQ(targets.vertices(0), Complex(1, 2));
    EXPECT_EQ(targets.maps[2](complex_of(mesh.V.row(7).transpose())), Complex(1, 2));
}

TEST(Rows, OfEveryHandleMeetTheirTargetsWhenTheMeshMovesByTheMap) {
    // Points and bones that the outline clips too: the mean of their discs lies off their places.
    const TriangleMesh mesh = reference::figure(400, 6);
    namespace places = reference::figure_places;
    Rig rig = rig_of_points({400 * places::head, 400 * places::left_hand, 400 * places::right_foot});
    rig.handles.push_back({"bone", BoneHandle{400 * places::chest, 400 * places::right_shoulder, ""}});
    rig.handles.push_back({"child", BoneHandle{400 * places::right_shoulder, 400 * places::right_hand, "bone"}});
    rig.handles.push_back({"torso", RegionHandle{box(180, 200, 220, 260)}});
    Pose pose;
    for (const char* id : {"p0", "p1", "p2", "bone", "torso"}) pose.handles[id].affine = sheared;
    EXPECT_LT(largest_miss(mesh, rig, pose, shear), 1e-10);
    for (const AffineMap& map : resolved(mesh, rig, pose).maps) {
        EXPECT_LT(std::abs(map({12, 34}) - shear({12, 34})), 1e-12);
    }
}

TEST(Targets, APointsMapIsItsMoveItsTurnAndItsScale) {
    const TriangleMesh mesh = reference::grid(20, 20, 100, 100);
    Pose pose;
    pose.handles["p0"].to = Point(60, 45);
    pose.handles["p0"].rotate_rad = 0.5;
    pose.handles["p1"].scale = 2;
    pose.handles["p1"].turn_rad = 7;
    const Targets targets = resolved(mesh, rig_of_points({{50, 50}, {20, 20}, {80, 20}}), pose, AffineUse::no);
    const auto near = [](Complex a, Complex b) { return std::abs(a - b) < 1e-12; };
    EXPECT_TRUE(near(targets.maps[0]({53, 50}), Complex(60, 45) + std::polar(3.0, 0.5)));
    EXPECT_TRUE(near(targets.maps[1]({20, 21}), {20, 22}));
    EXPECT_EQ(targets.maps[2]({7, 8}), Complex(7, 8));
    EXPECT_EQ(targets.holds[1].scale, 2);
    EXPECT_EQ(targets.holds[1].turn_rad, 7);
    EXPECT_FALSE(targets.holds[1].rotate_rad || targets.holds[1].shear);
    EXPECT_FALSE(targets.holds[2].rotate_rad || targets.holds[2].scale || targets.holds[2].turn_rad);
}

TEST(Targets, StayWithinAMillionSizes) {
    const TriangleMesh mesh = reference::grid(20, 20, 100, 100);
    Rig rig = rig_of_points({{50, 50}});
    rig.handles.push_back({"v", VertexHandle{3}});
    rig.handles.push_back({"torso", RegionHandle{box(60, 60, 90, 90)}});
    rig.handles.push_back({"arm", BoneHandle{{20, 20}, {20, 60}, ""}});
    for (const char* id : {"p0", "v", "torso", "arm"}) {
        Pose pose;
        pose.handles[id].to = Point(1e12, 0);
        EXPECT_THAT(message_of([&] { resolved(mesh, rig, pose); }),
                    AllOf(HasSubstr(std::string("'") + id + "'"), HasSubstr("too far")));
    }
}

TEST(Targets, ManyHandlesKeepTheirOrder) {
    const TriangleMesh mesh = reference::grid(120, 120, 1000, 1000);
    std::vector<int> indices;
    indices.reserve(5000);
    std::vector<Point> places;
    places.reserve(1000);
    for (int v = 0; v < 5000; ++v) indices.push_back(14000 - 2 * v);
    for (int k = 0; k < 1000; ++k) places.emplace_back(17 + 31 * (k % 32), 13 + 31 * (k / 32));
    Rig rig = rig_of_vertices(indices);
    for (const Handle& point : rig_of_points(places).handles) rig.handles.push_back(point);
    const Complex shift(30, -4);
    Pose pose;
    for (const Handle& handle : rig.handles) {
        const auto* point = std::get_if<PointHandle>(&handle.shape);
        const auto* vertex = std::get_if<VertexHandle>(&handle.shape);
        const Point at = point ? point->at : Point(mesh.V.row(vertex->index).transpose());
        pose.handles[handle.id].to = at + Point(shift.real(), shift.imag());
    }
    const Binding binding = take_hold(mesh, rig, "test");
    EXPECT_EQ(binding.holds.size(), 1000u);
    EXPECT_EQ(binding.vertices.size(), 5000u);
    EXPECT_LT(largest_miss(mesh, rig, pose, [&](Complex z) { return z + shift; }), 1e-10);
}

TEST(Loose, ComponentsThatNothingHoldsAreNamedByTheirLargest) {
    TriangleMesh mesh = reference::joined(reference::grid(10, 10, 100, 100), reference::grid(2, 2, 20, 20), {200, 0});
    EXPECT_TRUE(take_hold(mesh, rig_of("all", RegionHandle{box(-1, -1, 300, 300)}), "test").warnings.empty());
    const Rig rig = rig_of_vertices({0});
    const Binding one = take_hold(mesh, rig, "test");
    for (int v = 0; v < mesh.V.rows(); ++v) EXPECT_EQ(one.loose[static_cast<std::size_t>(v)], mesh.V(v, 0) > 150);
    ASSERT_EQ(one.warnings.size(), 1u);
    EXPECT_THAT(one.warnings[0], HasSubstr("around (210, 10)"));
    mesh = reference::joined(mesh, reference::grid(6, 6, 40, 40), {400, 0});
    const Binding two = take_hold(mesh, rig, "test");
    ASSERT_EQ(two.warnings.size(), 1u);
    EXPECT_THAT(two.warnings[0], AllOf(HasSubstr("2 parts"), HasSubstr("around (420, 20)")));
}

}  // namespace
}  // namespace puppetwarp
