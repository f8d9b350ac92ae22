#include "model/puppet_edits.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puppetwarp::ui {

namespace {

auto find_by_name(auto& poses, const std::string& name) {
    return std::find_if(poses.begin(), poses.end(), [&](const Pose& pose) { return pose.name == name; });
}

Pose& pose_to_edit(Puppet& puppet, const std::string& name) {
    const auto found = find_by_name(puppet.poses, name);
    if (found != puppet.poses.end()) return *found;
    puppet.poses.push_back({name, 0, {}});
    return puppet.poses.back();
}

// Nearer turns are found by any way.
constexpr double far_turn_rad = std::numbers::pi / 6;

double in_whole_degrees(double angle_rad) {
    return std::round(angle_rad * 180 / std::numbers::pi) * std::numbers::pi / 180;
}

bool has_free_angle(const Pose& pose, const std::string& id) {
    const auto found = pose.handles.find(id);
    return found == pose.handles.end() || !(found->second.rotate_rad || found->second.affine);
}

bool says_something(const HandlePose& pose) {
    return pose.to || pose.from || pose.points || pose.rotate_rad || pose.turn_rad || pose.scale || pose.depth ||
           pose.affine;
}

std::string unused_id(const Rig& rig) {
    for (std::size_t number = rig.handles.size() + 1;; ++number) {
        std::string id = "pin" + std::to_string(number);
        if (!find_handle(rig, id)) return id;
    }
}

}  // namespace

std::vector<Pin> pins(const Puppet& puppet, const Pose& pose) {
    std::vector<Pin> result;
    for (const Handle& handle : puppet.rig.handles) {
        const auto* point = std::get_if<PointHandle>(&handle.shape);
        if (!point) continue;
        const auto moved = pose.handles.find(handle.id);
        const bool stays = moved == pose.handles.end() || !moved->second.to;
        result.push_back({handle.id, point->at, stays ? point->at : *moved->second.to});
    }
    return result;
}

Pose pose_or_rest(const Puppet& puppet, const std::string& name) {
    const auto found = find_by_name(puppet.poses, name);
    return found != puppet.poses.end() ? *found : Pose{name, 0, {}};
}

std::string add_pin(Puppet& puppet, const std::string& pose, const Point& at, const Point& to) {
    std::string id = unused_id(puppet.rig);
    puppet.rig.handles.push_back({id, PointHandle{at, {}}});
    if (at != to) move_pin(puppet, pose, id, to);
    return id;
}

void move_pin(Puppet& puppet, const std::string& pose, const std::string& id, const Point& to) {
    pose_to_edit(puppet, pose).handles[id].to = to;
}

Pose with_turns(Pose pose, const std::map<std::string, double>& turns) {
    const bool far = std::any_of(turns.begin(), turns.end(), [&](const auto& turn) {
        return std::abs(turn.second) > far_turn_rad && has_free_angle(pose, turn.first);
    });
    for (const auto& [id, turn_rad] : turns) {
        if (!has_free_angle(pose, id)) continue;
        if (far) {
            pose.handles[id].turn_rad = in_whole_degrees(turn_rad);
        } else if (const auto found = pose.handles.find(id); found != pose.handles.end()) {
            found->second.turn_rad.reset();
            if (!says_something(found->second)) pose.handles.erase(found);
        }
    }
    return pose;
}

void keep_turns(Puppet& puppet, const std::string& pose, const std::map<std::string, double>& turns) {
    Pose kept = with_turns(pose_or_rest(puppet, pose), turns);
    if (!kept.handles.empty() || find_by_name(puppet.poses, pose) != puppet.poses.end())
        pose_to_edit(puppet, pose) = std::move(kept);
}

void remove_handle(Puppet& puppet, const std::string& id) {
    std::erase_if(puppet.rig.handles, [&](const Handle& handle) { return handle.id == id; });
    for (Handle& handle : puppet.rig.handles) {
        auto* bone = std::get_if<BoneHandle>(&handle.shape);
        if (bone && bone->parent == id) bone->parent.clear();
    }
    for (Pose& pose : puppet.poses) pose.handles.erase(id);
}

void clear_pose(Puppet& puppet, const std::string& pose) {
    const auto found = find_by_name(puppet.poses, pose);
    if (found != puppet.poses.end()) found->handles.clear();
}

}  // namespace puppetwarp::ui
