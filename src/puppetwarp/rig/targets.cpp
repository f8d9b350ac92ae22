#include <puppetwarp/rig/binding.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/rig/bones.h>
#include <puppetwarp/rig/handle_maps.h>

#include <cmath>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

Complex complex_of(const Point& p) {
    return {p.x(), p.y()};
}

std::string subject_of(const Handle& handle) {
    return "handle '" + handle.id + "'";
}

// What a pose says of each handle of a rig, in the rig's order.
std::vector<HandlePose> handle_poses(const Rig& rig, const Pose& pose) {
    std::vector<HandlePose> poses(rig.handles.size());
    for (std::size_t h = 0; h < poses.size(); ++h) {
        const auto found = pose.handles.find(rig.handles[h].id);
        if (found != pose.handles.end()) poses[h] = found->second;
    }
    return poses;
}

// A turn as a hold's target; the move is not set.
HoldTarget turn_target(const HandlePose& pose) {
    HoldTarget target;
    if (pose.affine) {
        const AffineMap map = affine_map(*pose.affine);
        target.rotate_rad = std::arg(map.alpha);
        target.scale = std::abs(map.alpha);
        target.shear = map.beta;
        return target;
    }
    target.rotate_rad = pose.rotate_rad;
    target.scale = pose.scale;
    if (!pose.rotate_rad) target.turn_rad = pose.turn_rad;
    return target;
}

bool same_turn(const HoldTarget& a, const HoldTarget& b) {
    constexpr double tolerance = 1e-9;
    if (a.rotate_rad && b.rotate_rad &&
        std::abs(std::polar(1.0, *a.rotate_rad) - std::polar(1.0, *b.rotate_rad)) > tolerance) {
        return false;
    }
    if (a.scale && b.scale && std::abs(*a.scale - *b.scale) > tolerance) return false;
    return !a.shear || !b.shear || std::abs(*a.shear - *b.shear) <= tolerance;
}

// What `other` fixes and `target` leaves free.
void complete(HoldTarget& target, const HoldTarget& other) {
    if (!target.rotate_rad) target.rotate_rad = other.rotate_rad;
    if (!target.scale) target.scale = other.scale;
    if (!target.shear) target.shear = other.shear;
    if (!target.turn_rad) target.turn_rad = other.turn_rad;
    if (target.rotate_rad) target.turn_rad.reset();
}

class Resolver {
public:
    Resolver(const Binding& binding, const TriangleMesh& mesh, const Rig& rig, const Pose& pose)
        : binding_(binding), mesh_(mesh), rig_(rig), size_(bounding_diagonal(mesh.V)), poses_(handle_poses(rig, pose)) {
        targets_.maps = handle_maps(rig, pose, mesh.V);
    }

    void require_no_affine_points(std::string_view user) const;
    Targets targets();

private:
    const HandlePose& pose_of(int handle) const { return poses_[static_cast<std::size_t>(handle)]; }
    const Handle& handle(int handle) const { return rig_.handles[static_cast<std::size_t>(handle)]; }
    Complex rest(int vertex) const { return {mesh_.V(vertex, 0), mesh_.V(vertex, 1)}; }

    HoldTarget hold_target(const Hold& hold) const;
    void place_vertices();
    void meet(const Meeting& meeting);
    void require_near(int handle, const Complex& move) const;

    const Binding& binding_;
    const TriangleMesh& mesh_;
    const Rig& rig_;
    double size_;
    std::vector<HandlePose> poses_;
    Targets targets_;
};

void Resolver::require_no_affine_points(std::string_view user) const {
    for (std::size_t h = 0; h < poses_.size(); ++h) {
        if (!poses_[h].affine || !std::holds_alternative<PointHandle>(rig_.handles[h].shape)) continue;
        throw InvalidInput(subject_of(rig_.handles[h]), "'" + std::string(user) + "' cannot use an affine map",
                           "give to, rotate_deg and scale");
    }
}

void Resolver::require_near(int handle, const Complex& move) const {
    if (std::abs(move) <= farthest_move * size_) return;
    throw InvalidInput(subject_of(this->handle(handle)), "its target is too far away",
                       "stay within a million times the subject's size");
}

HoldTarget Resolver::hold_target(const Hold& hold) const {
    const AffineMap& map = targets_.maps[static_cast<std::size_t>(hold.handle)];
    const HandlePose& pose = pose_of(hold.handle);
    const auto* point = std::get_if<PointHandle>(&handle(hold.handle).shape);
    HoldTarget target = point != nullptr ? turn_target(pose) : HoldTarget();
    if (point != nullptr && !pose.affine) {
        if (pose.to) target.move = complex_of(*pose.to - point->at);
    } else {
        Complex mean = 0;
        for (const auto& [vertex, weight] : hold.mean) mean += weight.real() * rest(vertex);
        target.move = map(mean) - mean;
    }
    require_near(hold.handle, target.move);
    return target;
}

void Resolver::place_vertices() {
    targets_.vertices.resize(static_cast<Eigen::Index>(binding_.vertices.size()));
    Eigen::Index i = 0;
    for (const auto& [h, vertex] : binding_.vertices) {
        const Complex from = rest(vertex);
        const bool single = std::holds_alternative<VertexHandle>(handle(h).shape);
        targets_.vertices(i) =
            single && pose_of(h).to ? complex_of(*pose_of(h).to) : targets_.maps[static_cast<std::size_t>(h)](from);
        require_near(h, targets_.vertices(i++) - from);
    }
}

void Resolver::meet(const Meeting& meeting) {
    const auto move = [&](int h, const Complex& place) {
        return targets_.maps[static_cast<std::size_t>(h)](place) - place;
    };
    const HoldTarget first = turn_target(pose_of(meeting.first)), second = turn_target(pose_of(meeting.second));
    const bool points = std::holds_alternative<PointHandle>(handle(meeting.first).shape) &&
                        std::holds_alternative<PointHandle>(handle(meeting.second).shape);
    const double apart =
        std::abs(move(meeting.first, meeting.first_place) - move(meeting.second, meeting.second_place));
    if (!(apart <= meeting.near_px) || (points && !same_turn(first, second))) {
        throw InvalidInput("handles '" + handle(meeting.first).id + "' and '" + handle(meeting.second).id + "'",
                           meeting.vertex ? "they hold one vertex but are sent to different places"
                                          : "they are in one place but are sent to different ones",
                           "remove one of them");
    }
    if (meeting.hold >= 0) complete(targets_.holds[static_cast<std::size_t>(meeting.hold)], second);
}

Targets Resolver::targets() {
    for (const Hold& hold : binding_.holds) targets_.holds.push_back(hold_target(hold));
    place_vertices();
    for (const Meeting& meeting : binding_.meetings) meet(meeting);
    return std::move(targets_);
}

}  // namespace

Targets resolve(const Binding& binding, const TriangleMesh& mesh, const Rig& rig, const Pose& pose, AffineUse affine,
                std::string_view user) {
    require_sound(pose, rig);
    Resolver resolver(binding, mesh, rig, pose);
    if (affine == AffineUse::no) resolver.require_no_affine_points(user);
    return resolver.targets();
}

}  // namespace puppetwarp
