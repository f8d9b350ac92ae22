#include "support/message_of.h"

#include <puppetwarp/rig/bones.h>
#include <puppetwarp/rig/inverse_kinematics.h>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace puppetwarp {
namespace {

using Complex = std::complex<double>;

// Bones b0, b1, ... through these places, each the child of the one before.
Rig chain_through(const std::vector<Point>& places) {
    Rig rig;
    for (std::size_t i = 0; i + 1 < places.size(); ++i) {
        rig.handles.push_back(
            {"b" + std::to_string(i), BoneHandle{places[i], places[i + 1], i == 0 ? "" : "b" + std::to_string(i - 1)}});
    }
    return rig;
}

std::string last_of(const Rig& rig) {
    return rig.handles.back().id;
}

// Where bone h has its start and its end in a pose.
std::pair<Complex, Complex> ends_of(const Rig& rig, const Pose& pose, std::size_t h) {
    const auto& bone = std::get<BoneHandle>(rig.handles[h].shape);
    const AffineMap map = bone_maps(rig, pose)[h];
    return {map({bone.from.x(), bone.from.y()}), map({bone.to.x(), bone.to.y()})};
}

double length_of(const Rig& rig, const Pose& pose, std::size_t h) {
    const auto [from, to] = ends_of(rig, pose, h);
    return std::abs(to - from);
}

Complex end_of(const Rig& rig, const Pose& pose) {
    return ends_of(rig, pose, rig.handles.size() - 1).second;
}

std::vector<Point> random_places(std::mt19937& random, int bones) {
    std::uniform_real_distribution<double> length(20, 100), turn(-1.2, 1.2);
    std::vector<Point> places{{100, 100}};
    double angle = turn(random);
    for (int i = 0; i < bones; ++i) {
        places.push_back(places.back() + length(random) * Point(std::cos(angle), std::sin(angle)));
        angle += turn(random);
    }
    return places;
}

TEST(InverseKinematics, ForwardKinematicsPutsTheEndWhereItShallBe) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> share(0, 1), angle(0, 2 * std::numbers::pi);
    for (const int bones : {2, 3, 5, 20}) {
        for (int round = 0; round < 40; ++round) {
            const Rig rig = chain_through(random_places(random, bones));
            double total = 0, longest = 0;
            for (std::size_t h = 0; h < rig.handles.size(); ++h) {
                const double length = length_of(rig, {}, h);
                total += length;
                longest = std::max(longest, length);
            }
            // What the chain can reach: not nearer than its longest bone less all the others.
            const double least = std::max(0.0, 2 * longest - total);
            const double distance = least + share(random) * (total - least);
            const Point target = Point(100, 100) + Eigen::Rotation2Dd(angle(random)) * Point(distance, 0);
            const Reached reached = reach(rig, {}, last_of(rig), target, bones);
            EXPECT_LE(std::abs(end_of(rig, reached.pose) - Complex(target.x(), target.y())), 1e-9 * total)
                << bones << " bones, round " << round;
            EXPECT_LE(reached.distance_px, 1e-9 * total);
            for (std::size_t h = 0; h < rig.handles.size(); ++h) {
                EXPECT_NEAR(length_of(rig, reached.pose, h), length_of(rig, {}, h), 1e-12 * total);
            }
            EXPECT_LE(std::abs(ends_of(rig, reached.pose, 0).first - Complex(100, 100)), 1e-12 * total);
        }
    }
}

TEST(InverseKinematics, TwoBonesKeepTheSideToWhichTheyBend) {
    for (const double side : {-1.0, 1.0}) {
        const Rig rig = chain_through({{0, 0}, {100, 20 * side}, {200, 0}});
        for (const Point& target : {Point(150, 30), Point(-60, 80), Point(20, -150), Point(5, 0)}) {
            const Reached reached = reach(rig, {}, "b1", target);
            const Complex elbow = ends_of(rig, reached.pose, 1).first;
            const double across = (std::conj(Complex(target.x(), target.y())) * elbow).imag();
            EXPECT_GT(across * side, 0);
        }
    }
}

TEST(InverseKinematics, TargetsThatAreNotReachedAreSaid) {
    const Rig rig = chain_through({{0, 0}, {100, 20}, {160, 0}});
    const auto warnings = [&](const Point& target) {
        Pose pose;
        pose.handles["b1"].reach = target;
        return reach_warnings(rig, pose);
    };
    EXPECT_TRUE(reach_warnings(rig, {}).empty());
    EXPECT_TRUE(warnings({120, 60}).empty());
    const double longest = std::hypot(100, 20) + std::hypot(60, 20),
                 shortest = std::hypot(100, 20) - std::hypot(60, 20);
    EXPECT_TRUE(warnings({longest, 0}).empty());
    ASSERT_EQ(warnings({longest + 25, 0}).size(), 1u);
    EXPECT_EQ(warnings({longest + 25, 0})[0], "handle 'b1': its chain cannot come to its target and stays 25 px away");
    EXPECT_EQ(warnings({0, 12.5 - shortest}).size(), 1u);  // too near
}

TEST(InverseKinematics, BendsFromWhereThePoseHasTheChain) {
    const Rig rig = chain_through({{0, 0}, {100, 0}, {200, 0}});
    Pose up, down;
    up.handles["b1"].rotate_rad = 0.5;
    down.handles["b1"].rotate_rad = -0.5;
    const Complex first = ends_of(rig, reach(rig, up, "b1", {150, 0}).pose, 1).first;
    const Complex second = ends_of(rig, reach(rig, down, "b1", {150, 0}).pose, 1).first;
    EXPECT_NEAR(std::abs(first - std::conj(second)), 0, 1e-9);
    EXPECT_LT(first.imag(), -1);  // the elbow is on the other side of the line than the forearm turned to
}

TEST(InverseKinematics, OutOfReachIsStraightTowardsTheTarget) {
    for (const int bones : {1, 2, 4}) {
        std::mt19937 random(3);
        const Rig rig = chain_through(random_places(random, bones));
        double total = 0;
        for (std::size_t h = 0; h < rig.handles.size(); ++h) total += length_of(rig, {}, h);
        const Reached reached = reach(rig, {}, last_of(rig), {100, 100 + 3 * total}, bones);
        EXPECT_NEAR(reached.distance_px, 2 * total, 1e-9 * total);
        EXPECT_NEAR(std::abs(end_of(rig, reached.pose) - Complex(100, 100 + total)), 0, 1e-6 * total);
    }
    const Rig uneven = chain_through({{0, 0}, {100, 0}, {130, 10}});
    const Reached near = reach(uneven, {}, "b1", {0, 20});
    EXPECT_NEAR(near.distance_px, 100 - std::hypot(30, 10) - 20, 1e-9);
}

TEST(InverseKinematics, AStraightChainBendsToo) {
    for (const int bones : {2, 3, 200}) {
        std::vector<Point> places;
        for (int i = 0; i <= bones; ++i) places.emplace_back(10.0 * i, 0);
        const Rig rig = chain_through(places);
        const Reached reached = reach(rig, {}, last_of(rig), {5.0 * bones, 0}, bones);
        EXPECT_LE(reached.distance_px, 1e-7 * bones) << bones;
    }
}

TEST(InverseKinematics, ATargetOnTheChainsStartIsDefined) {
    const Rig even = chain_through({{0, 0}, {100, 0}, {100, 100}});
    EXPECT_LE(reach(even, {}, "b1", {0, 0}).distance_px, 1e-9);
    const Rig one = chain_through({{0, 0}, {100, 0}});
    const Reached kept = reach(one, {}, "b0", {0, 0}, 1);
    EXPECT_LE(std::abs(end_of(one, kept.pose) - Complex(100, 0)), 1e-12) << "keeps its direction";
}

TEST(InverseKinematics, APoseMayReach) {
    Rig rig = chain_through({{0, 0}, {100, 0}, {100, 100}});
    rig.handles.push_back({"hand", BoneHandle{{100, 100}, {100, 120}, "b1"}});
    Pose pose;
    pose.handles["b1"].reach = Point(60, -90);
    EXPECT_LE(std::abs(ends_of(rig, pose, 1).second - Complex(60, -90)), 1e-9);
    EXPECT_LE(std::abs(ends_of(rig, pose, 2).first - Complex(60, -90)), 1e-9) << "children follow";
    pose.handles["b1"].chain = 1;
    EXPECT_LE(std::abs(ends_of(rig, pose, 0).second - Complex(100, 0)), 1e-9) << "the parent stays";
}

TEST(InverseKinematics, RefusesWhatContradictsItself) {
    const Rig rig = chain_through({{0, 0}, {100, 0}, {100, 100}, {200, 100}});
    const auto refusal = [&](const Pose& pose) {
        return message_of([&] {
            require_sound(pose, rig);
            bone_maps(rig, pose);
        });
    };
    Pose pose;
    pose.handles["b2"].reach = Point(50, 50);
    EXPECT_EQ(refusal(pose), "");
    Pose both = pose;
    both.handles["b2"].rotate_rad = 1;
    EXPECT_EQ(refusal(both), "handle 'b2': reach cannot stand beside to, rotate_deg or affine (give one or the other)");
    Pose sent = pose;
    sent.handles["b1"].to = Point(3, 3);
    EXPECT_EQ(refusal(sent),
              "handle 'b1': 'to' cannot stand in a chain that bends to reach a target (leave it out, or "
              "make the chain shorter)");
    Pose twice = pose;
    twice.handles["b1"].reach = Point(3, 3);
    EXPECT_EQ(refusal(twice),
              "handle 'b1': two chains that reach for targets share this bone (make one of them shorter)");
    Pose endless = pose;
    endless.handles["b2"].reach = Point(std::numeric_limits<double>::quiet_NaN(), 0);
    EXPECT_EQ(refusal(endless), "handle 'b2': reach is not a finite number");
    Pose none = pose;
    none.handles["b2"].chain = 0;
    EXPECT_EQ(refusal(none), "handle 'b2': chain must be at least 1");
    Pose lone;
    lone.handles["b2"].chain = 2;
    EXPECT_EQ(refusal(lone), "handle 'b2': chain says nothing without reach (give both)");
    EXPECT_EQ(message_of([&] {
                  reach(rig, {}, "nobody", {0, 0});
              }),
              "handle 'nobody': it is no bone of the rig, it cannot reach");
}

TEST(BoneMotions, AnglesAddUpAlongTheChain) {
    const Rig rig = chain_through({{0, 0}, {100, 0}, {200, 0}, {300, 0}});
    constexpr double degree = std::numbers::pi / 180;
    Pose pose;
    for (const char* id : {"b0", "b1", "b2"}) pose.handles[id].rotate_rad = 120 * degree;
    EXPECT_NEAR(bone_motions(rig, pose)[2].angle_rad, 360 * degree, 1e-12);
    pose.handles["b0"].rotate_rad = 400 * degree;
    EXPECT_NEAR(bone_motions(rig, pose)[0].angle_rad, 400 * degree, 1e-12);
    // By places: each to less than half a turn from its parent.
    Pose placed;
    Complex at = 0;
    for (std::size_t h = 0; h < 3; ++h) {
        at += std::polar(100.0, 100 * degree * static_cast<double>(h + 1));
        placed.handles["b" + std::to_string(h)].to = Point(at.real(), at.imag());
    }
    const std::vector<BoneMotion> motions = bone_motions(rig, placed);
    for (std::size_t h = 0; h < 3; ++h) {
        EXPECT_NEAR(motions[h].angle_rad, 100 * degree * static_cast<double>(h + 1), 1e-9);
    }
}

TEST(BoneMotions, ABoneOfFixedLengthTurnsOnly) {
    Rig rig = chain_through({{0, 0}, {100, 0}, {200, 0}});
    std::get<BoneHandle>(rig.handles[0].shape).length = BoneLength::fixed;
    Pose pose;
    pose.handles["b0"].to = Point(0, 300);
    EXPECT_NEAR(std::abs(ends_of(rig, pose, 0).second - Complex(0, 100)), 0, 1e-12);
    EXPECT_NEAR(length_of(rig, pose, 1), 100, 1e-12);
    std::get<BoneHandle>(rig.handles[0].shape).length = BoneLength::stretch;
    EXPECT_NEAR(std::abs(ends_of(rig, pose, 0).second - Complex(0, 300)), 0, 1e-12);
}

}  // namespace
}  // namespace puppetwarp
