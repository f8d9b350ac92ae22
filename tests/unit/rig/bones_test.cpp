#include <puppetwarp/rig/bones.h>

#include <puppetwarp/base/errors.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include <gmock/gmock.h>

#include <cmath>

namespace puppetwarp {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Matrix = Eigen::Matrix3d;  // of homogeneous coordinates: the reference, composed by hand

Matrix translation(const Point& by) {
    Matrix T = Matrix::Identity();
    T.topRightCorner<2, 1>() = by;
    return T;
}

// Clockwise on screen, as y points down.
Matrix rotation(double angle_rad, double scale = 1) {
    Matrix R = Matrix::Identity();
    R.topLeftCorner<2, 2>() << std::cos(angle_rad), -std::sin(angle_rad), std::sin(angle_rad), std::cos(angle_rad);
    R.topLeftCorner<2, 2>() *= scale;
    return R;
}

Matrix about(const Point& centre, const Matrix& map) {
    return translation(centre) * map * translation(-centre);
}

void expect_map(const AffineMap& map, const Matrix& expected) {
    for (const Point& p : {Point(0, 0), Point(10, 0), Point(0, 10), Point(-7, 31)}) {
        const std::complex<double> q = map({p.x(), p.y()});
        const Eigen::Vector3d r = expected * Eigen::Vector3d(p.x(), p.y(), 1);
        EXPECT_NEAR(q.real(), r.x(), 1e-12 * (1 + r.norm()));
        EXPECT_NEAR(q.imag(), r.y(), 1e-12 * (1 + r.norm()));
    }
}

// A chain with a branch; the child stands before its parents.
Rig skeleton() {
    Rig rig;
    rig.handles.push_back({"hand", BoneHandle{{30, 10}, {40, 12}, "arm"}});
    rig.handles.push_back({"spine", BoneHandle{{10, 40}, {10, 10}, ""}});
    rig.handles.push_back({"pin", PointHandle{{5, 5}, {}}});
    rig.handles.push_back({"arm", BoneHandle{{10, 10}, {30, 10}, "spine"}});
    rig.handles.push_back({"head", BoneHandle{{10, 10}, {10, 0}, "spine"}});
    return rig;
}

TEST(BoneMaps, AnglesAndScalesGoDownTheTree) {
    Pose pose;
    pose.handles["spine"].rotate_rad = 0.4;
    pose.handles["arm"].rotate_rad = -1.1;
    pose.handles["arm"].scale = 1.5;
    pose.handles["hand"].rotate_rad = 2.5;
    pose.handles["pin"].rotate_rad = 1;
    const std::vector<AffineMap> maps = bone_maps(skeleton(), pose);
    const Matrix spine = about({10, 40}, rotation(0.4));
    const Matrix arm = spine * about({10, 10}, rotation(-1.1, 1.5));
    const Matrix hand = arm * about({30, 10}, rotation(2.5));
    ASSERT_EQ(maps.size(), 5u);
    expect_map(maps[1], spine);
    expect_map(maps[3], arm);
    expect_map(maps[0], hand);
    expect_map(maps[4], spine);  // follows
    expect_map(maps[2], Matrix::Identity());
}

TEST(BoneMaps, EndsMakeASimilarityThatChildrenFollow) {
    Pose pose;
    pose.handles["spine"].from = Point(12, 44);
    pose.handles["spine"].to = Point(2, 14);  // from (0, -30) to (-10, -30)
    const std::vector<AffineMap> maps = bone_maps(skeleton(), pose);
    const double length = std::hypot(10, 30);
    const Matrix spine = translation({12, 44}) * rotation(-std::atan2(10, 30), length / 30) * translation({-10, -40});
    for (const std::size_t bone : {0u, 1u, 3u, 4u}) expect_map(maps[bone], spine);
}

TEST(BoneMaps, AnEndThatIsNotGivenFollowsTheParent) {
    Pose pose;
    pose.handles["spine"].rotate_rad = 0.7;
    pose.handles["arm"].to = Point(25, 33);
    pose.handles["head"].from = Point(50, 50);
    const std::vector<AffineMap> maps = bone_maps(skeleton(), pose);
    const Matrix spine = about({10, 40}, rotation(0.7));
    const Eigen::Vector3d joint = spine * Eigen::Vector3d(10, 10, 1);
    const Point along = Point(25, 33) - joint.head<2>();
    const Matrix arm = translation(joint.head<2>()) * rotation(std::atan2(along.y(), along.x()), along.norm() / 20) *
                       translation({-10, -10});
    expect_map(maps[3], arm);
    expect_map(maps[0], arm);
    expect_map(maps[4], translation(Point(50, 50) - joint.head<2>()) * spine);
}

TEST(BoneMaps, AnAffineMapIsTakenAsGivenAndGoesDown) {
    Pose pose;
    pose.handles["spine"].rotate_rad = 0.7;
    pose.handles["arm"].affine = std::array<double, 6>{1.5, 0.25, -0.5, 0.75, 4, -3};
    pose.handles["hand"].rotate_rad = 0.3;
    const std::vector<AffineMap> maps = bone_maps(skeleton(), pose);
    Matrix arm;
    arm << 1.5, -0.5, 4, 0.25, 0.75, -3, 0, 0, 1;
    expect_map(maps[3], arm);
    expect_map(maps[0], arm * about({30, 10}, rotation(0.3)));
}

TEST(BoneMaps, RestAndTheRestPoseSpelledOutAreTheIdentityToTheBit) {
    Pose spelled;
    for (const Handle& handle : skeleton().handles) {
        const auto* bone = std::get_if<BoneHandle>(&handle.shape);
        if (bone == nullptr) continue;
        spelled.handles[handle.id].from = bone->from;
        spelled.handles[handle.id].to = bone->to;
    }
    for (const Pose& pose : {Pose(), spelled}) {
        for (const AffineMap& map : bone_maps(skeleton(), pose)) {
            EXPECT_EQ(map({1.0 / 3, 0.1}), std::complex<double>(1.0 / 3, 0.1));
        }
    }
}

TEST(BoneMaps, ABoneMustKeepALength) {
    Pose pose;
    pose.handles["arm"].to = Point(10, 10);
    try {
        bone_maps(skeleton(), pose);
        FAIL();
    } catch (const InvalidInput& error) {
        EXPECT_THAT(error.what(), AllOf(HasSubstr("'arm'"), HasSubstr("one place")));
    }
}

TEST(AffineMap, ComposesAsMatricesDo) {
    const std::array<double, 6> f{1.5, 0.25, -0.5, 0.75, 4, -3}, g{-0.5, 2, 1, 0.1, 7, 11};
    const auto matrix = [](const std::array<double, 6>& e) {
        Matrix A;
        A << e[0], e[2], e[4], e[1], e[3], e[5], 0, 0, 1;
        return A;
    };
    expect_map(affine_map(f), matrix(f));
    expect_map(composed(affine_map(f), affine_map(g)), matrix(f) * matrix(g));
}

}  // namespace
}  // namespace puppetwarp
