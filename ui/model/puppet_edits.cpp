#include "model/puppet_edits.h"

#include <algorithm>

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
