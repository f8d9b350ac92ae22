#include <puppetwarp/rig/bones.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/rig/inverse_kinematics.h>

#include <cmath>
#include <numbers>
#include <unordered_map>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

Complex complex_of(const Point& p) {
    return {p.x(), p.y()};
}

// The map of a bone when its parent moves by `parent`.
AffineMap bone_map(const std::string& id, const BoneHandle& bone, const HandlePose& pose, const AffineMap& parent) {
    if (pose.affine) return affine_map(*pose.affine);
    const Complex from = complex_of(bone.from), to = complex_of(bone.to);
    const Complex new_from = pose.from ? complex_of(*pose.from) : parent(from);
    if (pose.to) {
        const Complex rest = to - from, along = complex_of(*pose.to) - new_from;
        if (along == 0.0) throw InvalidInput("handle '" + id + "'", "both ends of the bone are sent to one place");
        // A quotient of equals may miss 1 by round-off.
        Complex turn = along == rest ? Complex(1) : along / rest;
        if (bone.length == BoneLength::fixed) turn *= std::abs(parent.alpha) / std::abs(turn);
        return similarity_about(from, turn, new_from);
    }
    const Complex turn = std::polar(pose.scale.value_or(1), pose.rotate_rad.value_or(0));
    AffineMap map = composed(parent, similarity_about(from, turn, from));
    if (pose.from) map.shift += new_from - map(from);
    return map;
}

BoneMotion bone_motion(const std::string& id, const BoneHandle& bone, const HandlePose& pose,
                       const BoneMotion& parent) {
    BoneMotion motion{bone_map(id, bone, pose, parent.map), parent.angle_rad};
    // Turned by this much, to less than half a turn more.
    const double said = motion.angle_rad + pose.rotate_rad.value_or(0);
    motion.angle_rad = said + std::remainder(std::arg(motion.map.alpha) - said, 2 * std::numbers::pi);
    return motion;
}

class Skeleton {
public:
    Skeleton(const Rig& rig, const Pose& pose)
        : rig_(rig), pose_(pose), motions_(rig.handles.size()), known_(rig.handles.size()) {
        for (std::size_t h = 0; h < rig.handles.size(); ++h) {
            if (std::holds_alternative<BoneHandle>(rig.handles[h].shape)) bones_.emplace(rig.handles[h].id, h);
        }
    }

    std::vector<BoneMotion> motions() {
        for (const auto& handle : rig_.handles) {
            const auto* bone = std::get_if<BoneHandle>(&handle.shape);
            if (bone != nullptr) settle(handle.id);
        }
        return std::move(motions_);
    }

private:
    // From the bone up to the first one whose map is known, then down again: a long chain needs no deep stack.
    void settle(const std::string& id) {
        std::vector<std::size_t> chain;
        const std::string* next = &id;
        while (!next->empty()) {
            const std::size_t h = bones_.at(*next);
            if (known_[h]) break;
            chain.push_back(h);
            next = &std::get<BoneHandle>(rig_.handles[h].shape).parent;
        }
        for (; !chain.empty(); chain.pop_back()) {
            const std::size_t h = chain.back();
            const Handle& handle = rig_.handles[h];
            const auto& bone = std::get<BoneHandle>(handle.shape);
            const auto found = pose_.handles.find(handle.id);
            const HandlePose pose = found == pose_.handles.end() ? HandlePose() : found->second;
            const BoneMotion parent = bone.parent.empty() ? BoneMotion() : motions_[bones_.at(bone.parent)];
            motions_[h] = bone_motion(handle.id, bone, pose, parent);
            known_[h] = true;
        }
    }

    const Rig& rig_;
    const Pose& pose_;
    std::unordered_map<std::string_view, std::size_t> bones_;
    std::vector<BoneMotion> motions_;
    std::vector<bool> known_;
};

}  // namespace

std::vector<BoneMotion> bone_motions(const Rig& rig, const Pose& pose) {
    const Pose bent = with_reaches(rig, pose);
    return Skeleton(rig, bent).motions();
}

std::vector<AffineMap> bone_maps(const Rig& rig, const Pose& pose) {
    std::vector<AffineMap> maps;
    for (const BoneMotion& motion : bone_motions(rig, pose)) maps.push_back(motion.map);
    return maps;
}

AffineMap affine_map(const std::array<double, 6>& entries) {
    const auto [a, b, c, d, e, f] = entries;
    return {Complex(a + d, b - c) / 2.0, Complex(a - d, b + c) / 2.0, Complex(e, f)};
}

AffineMap composed(const AffineMap& outer, const AffineMap& inner) {
    return {outer.alpha * inner.alpha + outer.beta * std::conj(inner.beta),
            outer.alpha * inner.beta + outer.beta * std::conj(inner.alpha), outer(inner.shift)};
}

AffineMap similarity_about(Complex centre, Complex alpha, Complex to) {
    return {alpha, 0, to - alpha * centre};
}

}  // namespace puppetwarp
