#include <puppetwarp/rig/rig.h>

#include <puppetwarp/base/errors.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string_view>
#include <unordered_map>

namespace puppetwarp {

namespace {

std::string subject_of(const Handle& handle) {
    return "handle '" + handle.id + "'";
}

void require_finite(const std::string& subject, const std::string& field, double value) {
    if (!std::isfinite(value)) throw InvalidInput(subject, field + " is not a finite number");
}

void require_finite(const std::string& subject, const std::string& field, const Point& point) {
    require_finite(subject, field, point.x());
    require_finite(subject, field, point.y());
}

void require_finite(const std::string& subject, const std::string& field, const Polyline& points) {
    for (const Point& point : points) require_finite(subject, field, point);
}

void require_positive(const std::string& subject, const std::string& field, double value) {
    require_finite(subject, field, value);
    if (!(value > 0)) throw InvalidInput(subject, field + " must be above 0");
}

// Beyond, what is soft beside it drowns in round-off.
constexpr double most_stiffness = 1e6;

void require_stiffness(const std::string& subject, const std::string& field, double value) {
    require_positive(subject, field, value);
    if (value < 1 / most_stiffness || value > most_stiffness) {
        throw InvalidInput(subject, field + " must be between a millionth and a million");
    }
}

void require_polygon(const std::string& subject, const Polyline& points) {
    require_finite(subject, "points", points);
    if (points.size() < 3) throw InvalidInput(subject, "points must be a polygon of at least 3 corners");
}

// What a handle may be told in a pose, and what its own fields must look like, by type.
struct AllowedFields {
    bool to = false;
    bool from = false;
    bool points = false;
    bool turn = false;       // rotate_deg, scale and affine
    bool free_turn = false;  // turn_deg
    bool reach = false;      // reach and chain
    const char* type = "";
};

struct FieldsOf {
    AllowedFields operator()(const PointHandle&) const {
        return {.to = true, .turn = true, .free_turn = true, .type = "point"};
    }
    AllowedFields operator()(const BoneHandle&) const {
        return {.to = true, .from = true, .turn = true, .reach = true, .type = "bone"};
    }
    AllowedFields operator()(const CageHandle&) const { return {.points = true, .type = "cage"}; }
    AllowedFields operator()(const RegionHandle&) const { return {.to = true, .turn = true, .type = "region"}; }
    AllowedFields operator()(const VertexHandle&) const { return {.to = true, .type = "vertex"}; }
};

struct ShapeCheck {
    const std::string& subject;

    void operator()(const PointHandle& point) const {
        require_finite(subject, "at", point.at);
        if (point.radius_px) require_positive(subject, "radius_px", *point.radius_px);
    }
    void operator()(const BoneHandle& bone) const {
        require_finite(subject, "from", bone.from);
        require_finite(subject, "to", bone.to);
        if (bone.from == bone.to) throw InvalidInput(subject, "the bone has no length");
    }
    void operator()(const CageHandle& cage) const { require_polygon(subject, cage.points); }
    void operator()(const RegionHandle& region) const { require_polygon(subject, region.points); }
    void operator()(const VertexHandle& vertex) const {
        if (vertex.index < 0) throw InvalidInput(subject, "index must not be negative");
    }
};

struct StiffnessCheck {
    std::string subject;

    void operator()(const StiffnessRegion& region) const {
        require_polygon(subject, region.points);
        require_stiffness(subject, "value", region.value);
    }
    void operator()(const StiffnessPicture& picture) const {
        if (picture.path.empty() && picture.grey.empty()) throw InvalidInput(subject, "it names no picture");
        require_stiffness(subject, "max", picture.max);
    }
};

// Handles by their ids.
using HandleIndex = std::unordered_map<std::string_view, const Handle*>;

HandleIndex index_of(const Rig& rig) {
    HandleIndex index;
    for (const Handle& handle : rig.handles) index.emplace(handle.id, &handle);
    return index;
}

void require_parents(const HandleIndex& index, const Handle& handle) {
    const auto* bone = std::get_if<BoneHandle>(&handle.shape);
    for (std::size_t steps = 0; bone != nullptr && !bone->parent.empty(); ++steps) {
        if (steps > index.size()) throw InvalidInput(subject_of(handle), "its parents lead round in a loop");
        const std::string& parent = bone->parent;
        const auto found = index.find(parent);
        bone = found == index.end() ? nullptr : std::get_if<BoneHandle>(&found->second->shape);
        if (bone == nullptr) throw InvalidInput(subject_of(handle), "parent '" + parent + "' is not a bone of the rig");
    }
}

void require_allowed(const std::string& subject, const AllowedFields& allowed, bool set, bool fits, const char* field) {
    if (set && !fits) {
        throw InvalidInput(subject, std::string("a ") + allowed.type + " does not have '" + field + "'");
    }
}

void require_fields(const std::string& subject, const AllowedFields& allowed, const HandlePose& pose) {
    require_allowed(subject, allowed, pose.to.has_value(), allowed.to, "to");
    require_allowed(subject, allowed, pose.from.has_value(), allowed.from, "from");
    require_allowed(subject, allowed, pose.points.has_value(), allowed.points, "to (points)");
    require_allowed(subject, allowed, pose.rotate_rad.has_value(), allowed.turn, "rotate_deg");
    require_allowed(subject, allowed, pose.turn_rad.has_value(), allowed.free_turn, "turn_deg");
    require_allowed(subject, allowed, pose.scale.has_value(), allowed.turn, "scale");
    require_allowed(subject, allowed, pose.affine.has_value(), allowed.turn, "affine");
    require_allowed(subject, allowed, pose.reach.has_value(), allowed.reach, "reach");
    require_allowed(subject, allowed, pose.chain.has_value(), allowed.reach, "chain");
    if (pose.chain && !pose.reach) throw InvalidInput(subject, "chain says nothing without reach", "give both");
    if (pose.reach && (pose.to || pose.rotate_rad || pose.affine)) {
        throw InvalidInput(subject, "reach cannot stand beside to, rotate_deg or affine", "give one or the other");
    }
    if (pose.affine && (pose.to || pose.from || pose.rotate_rad || pose.scale)) {
        throw InvalidInput(subject, "affine cannot stand beside to, from, rotate_deg or scale",
                           "give one or the other");
    }
    if (allowed.from && pose.to && (pose.rotate_rad || pose.scale)) {
        throw InvalidInput(subject, "a bone's to cannot stand beside rotate_deg or scale, which it gives already",
                           "give one or the other");
    }
}

constexpr double most_turn_rad = 2000 * std::numbers::pi * (1 + 1e-12);  // 360,000 degrees, however rounded
// Beyond, numbers lose what the mesh is made of.
constexpr double most_scale = 1e6;
constexpr double most_depth = 1e6;

void require_angle(const std::string& subject, const std::string& field, double angle_rad) {
    require_finite(subject, field, angle_rad);
    if (std::abs(angle_rad) > most_turn_rad) {
        throw InvalidInput(subject, field + " turns more than a thousand times round");
    }
}

void require_values(const std::string& subject, const HandlePose& pose) {
    if (pose.to) require_finite(subject, "to", *pose.to);
    if (pose.from) require_finite(subject, "from", *pose.from);
    if (pose.points) require_finite(subject, "to", *pose.points);
    if (pose.reach) require_finite(subject, "reach", *pose.reach);
    if (pose.chain && *pose.chain < 1) throw InvalidInput(subject, "chain must be at least 1");
    if (pose.rotate_rad) require_angle(subject, "rotate_deg", *pose.rotate_rad);
    if (pose.turn_rad) require_angle(subject, "turn_deg", *pose.turn_rad);
    if (pose.scale) require_positive(subject, "scale", *pose.scale);
    if (pose.scale && *pose.scale > most_scale) throw InvalidInput(subject, "scale is above a million");
    if (pose.depth) require_finite(subject, "depth", *pose.depth);
    if (pose.depth && std::abs(*pose.depth) > most_depth) throw InvalidInput(subject, "depth is beyond a million");
    if (pose.affine) {
        for (const double entry : *pose.affine) require_finite(subject, "affine", entry);
        for (std::size_t i = 0; i < 4; ++i) {
            if (std::abs((*pose.affine)[i]) > most_scale)
                throw InvalidInput(subject, "affine scales by over a million");
        }
    }
}

}  // namespace

std::string bone_length_name(BoneLength length) {
    return length == BoneLength::stretch ? "stretch" : "fixed";
}

BoneLength bone_length_from_name(std::string_view name) {
    for (const BoneLength length : {BoneLength::stretch, BoneLength::fixed}) {
        if (bone_length_name(length) == name) return length;
    }
    throw InvalidInput("length '" + std::string(name) + "'", "there is none of this name", "known: stretch, fixed");
}

std::string falloff_name(Falloff falloff) {
    switch (falloff) {
        case Falloff::none: return "none";
        case Falloff::harmonic: return "harmonic";
        case Falloff::geodesic: break;
    }
    return "geodesic";
}

Falloff falloff_from_name(std::string_view name) {
    for (const Falloff falloff : {Falloff::none, Falloff::harmonic, Falloff::geodesic}) {
        if (falloff_name(falloff) == name) return falloff;
    }
    throw InvalidInput("falloff '" + std::string(name) + "'", "there is none of this name",
                       "known: none, harmonic, geodesic");
}

const Handle* find_handle(const Rig& rig, const std::string& id) {
    const auto found =
        std::find_if(rig.handles.begin(), rig.handles.end(), [&](const Handle& handle) { return handle.id == id; });
    return found == rig.handles.end() ? nullptr : &*found;
}

void require_sound(const Rig& rig) {
    std::set<std::string> ids;
    for (std::size_t i = 0; i < rig.handles.size(); ++i) {
        const Handle& handle = rig.handles[i];
        if (handle.id.empty()) throw InvalidInput("handle " + std::to_string(i), "its id is empty");
        const std::string subject = subject_of(handle);
        if (!ids.insert(handle.id).second) throw InvalidInput(subject, "the id is used twice");
        std::visit(ShapeCheck{subject}, handle.shape);
    }
    const HandleIndex index = index_of(rig);
    for (const Handle& handle : rig.handles) require_parents(index, handle);
    for (std::size_t i = 0; i < rig.stiffness.size(); ++i) {
        std::visit(StiffnessCheck{"stiffness " + std::to_string(i)}, rig.stiffness[i]);
    }
}

void require_sound(const Pose& pose, const Rig& rig) {
    const HandleIndex index = index_of(rig);
    for (const auto& [id, target] : pose.handles) {
        const auto found = index.find(id);
        if (found == index.end()) {
            throw InvalidInput("pose '" + pose.name + "'",
                               "it names the handle '" + id + "', which the rig does not have");
        }
        const Handle& handle = *found->second;
        const std::string subject = subject_of(handle);
        require_fields(subject, std::visit(FieldsOf{}, handle.shape), target);
        require_values(subject, target);
        const CageHandle* cage = std::get_if<CageHandle>(&handle.shape);
        if (cage != nullptr && target.points && target.points->size() != cage->points.size()) {
            throw InvalidInput(subject, "to has " + std::to_string(target.points->size()) + " points, the cage has " +
                                            std::to_string(cage->points.size()));
        }
    }
}

}  // namespace puppetwarp
