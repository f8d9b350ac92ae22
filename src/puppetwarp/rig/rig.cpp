#include <puppetwarp/rig/rig.h>

#include <puppetwarp/base/errors.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

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

void require_polygon(const std::string& subject, const Polyline& points) {
    require_finite(subject, "points", points);
    if (points.size() < 3) throw InvalidInput(subject, "points must be a polygon of at least 3 corners");
}

// What a handle may be told in a pose, and what its own fields must look like, by type.
struct AllowedFields {
    bool to = false;
    bool from = false;
    bool points = false;
    bool turn = false;  // rotate_deg, scale and affine
    const char* type = "";
};

struct FieldsOf {
    AllowedFields operator()(const PointHandle&) const { return {.to = true, .turn = true, .type = "point"}; }
    AllowedFields operator()(const BoneHandle&) const {
        return {.to = true, .from = true, .turn = true, .type = "bone"};
    }
    AllowedFields operator()(const CageHandle&) const { return {.points = true, .type = "cage"}; }
    AllowedFields operator()(const RegionHandle&) const { return {.turn = true, .type = "region"}; }
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
        require_positive(subject, "value", region.value);
    }
    void operator()(const StiffnessPicture& picture) const {
        if (picture.path.empty() && picture.grey.empty()) throw InvalidInput(subject, "it names no picture");
        require_positive(subject, "max", picture.max);
    }
};

const BoneHandle* bone_of(const Handle* handle) {
    return handle == nullptr ? nullptr : std::get_if<BoneHandle>(&handle->shape);
}

void require_parents(const Rig& rig, const Handle& handle) {
    const BoneHandle* bone = bone_of(&handle);
    for (std::size_t steps = 0; bone != nullptr && !bone->parent.empty(); ++steps) {
        if (steps > rig.handles.size()) throw InvalidInput(subject_of(handle), "its parents lead round in a loop");
        const std::string& parent = bone->parent;
        bone = bone_of(find_handle(rig, parent));
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
    require_allowed(subject, allowed, pose.scale.has_value(), allowed.turn, "scale");
    require_allowed(subject, allowed, pose.affine.has_value(), allowed.turn, "affine");
    if (pose.affine && (pose.to || pose.from || pose.rotate_rad || pose.scale)) {
        throw InvalidInput(subject, "affine cannot stand beside to, from, rotate_deg or scale",
                           "give one or the other");
    }
}

constexpr double most_turn_rad = 2000 * std::numbers::pi;

void require_values(const std::string& subject, const HandlePose& pose) {
    if (pose.to) require_finite(subject, "to", *pose.to);
    if (pose.from) require_finite(subject, "from", *pose.from);
    if (pose.points) require_finite(subject, "to", *pose.points);
    if (pose.rotate_rad) require_finite(subject, "rotate_deg", *pose.rotate_rad);
    if (pose.rotate_rad && std::abs(*pose.rotate_rad) > most_turn_rad) {
        throw InvalidInput(subject, "rotate_deg turns more than a thousand times round");
    }
    if (pose.scale) require_positive(subject, "scale", *pose.scale);
    if (pose.depth) require_finite(subject, "depth", *pose.depth);
    if (pose.affine) {
        for (const double entry : *pose.affine) require_finite(subject, "affine", entry);
    }
}

}  // namespace

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
    for (const Handle& handle : rig.handles) require_parents(rig, handle);
    for (std::size_t i = 0; i < rig.stiffness.size(); ++i) {
        std::visit(StiffnessCheck{"stiffness " + std::to_string(i)}, rig.stiffness[i]);
    }
}

void require_sound(const Pose& pose, const Rig& rig) {
    for (const auto& [id, target] : pose.handles) {
        const Handle* handle = find_handle(rig, id);
        if (handle == nullptr) {
            throw InvalidInput("pose '" + pose.name + "'",
                               "it names the handle '" + id + "', which the rig does not have");
        }
        const std::string subject = subject_of(*handle);
        require_fields(subject, std::visit(FieldsOf{}, handle->shape), target);
        require_values(subject, target);
        const CageHandle* cage = std::get_if<CageHandle>(&handle->shape);
        if (cage != nullptr && target.points && target.points->size() != cage->points.size()) {
            throw InvalidInput(subject, "to has " + std::to_string(target.points->size()) + " points, the cage has " +
                                            std::to_string(cage->points.size()));
        }
    }
}

}  // namespace puppetwarp
