#include <puppetwarp/project/puppet_json.h>

#include <algorithm>
#include <initializer_list>
#include <numbers>
#include <string_view>

namespace puppetwarp {

namespace {

// An angle read in degrees and written again shows the degrees that were typed, not the round-off of the way there.
Json degrees(double radians) {
    const double value = radians * 180 / std::numbers::pi;
    const double rounded = std::round(value * 1e9) / 1e9;
    return std::abs(value - rounded) <= 1e-12 * std::abs(value) ? rounded : value;
}

// Whole numbers are written without a fraction, as a person writes them.
Json number(double value) {
    if (value == std::floor(value) && std::abs(value) < 1e15) return static_cast<std::int64_t>(value);
    return value;
}

Json degrees_number(double radians) {
    return number(degrees(radians).get<double>());
}

Json point(const Point& p) {
    return Json::array({number(p.x()), number(p.y())});
}

Json points(const Polyline& polyline) {
    Json json = Json::array();
    for (const Point& p : polyline) json.push_back(point(p));
    return json;
}

// Appends what `old` has and this version does not know. \param known  keys that are ours: absent means dropped.
void keep_unknown(Json& json, const Json* old, std::initializer_list<std::string_view> known) {
    if (!old || !old->is_object()) return;
    for (const auto& [key, value] : old->items()) {
        if (std::find(known.begin(), known.end(), key) == known.end() && !json.contains(key)) json[key] = value;
    }
}

const Json* member(const Json* json, const char* key) {
    if (!json || !json->is_object()) return nullptr;
    const auto found = json->find(key);
    return found == json->end() ? nullptr : &*found;
}

// The element of an array of objects whose `key` is `value`.
const Json* element(const Json* array, const char* key, const std::string& value) {
    if (!array || !array->is_array()) return nullptr;
    for (const Json& json : *array) {
        const Json* name = member(&json, key);
        if (name && name->is_string() && name->get_ref<const std::string&>() == value) return &json;
    }
    return nullptr;
}

Json cutout_json(const CutoutSettings& cutout, const Json* old) {
    Json json{{"from", cutout.from}};
    if (!cutout.path.empty()) json["path"] = cutout.path;
    if (!cutout.points.empty()) json["points"] = points(cutout.points);
    for (const Polyline& hole : cutout.holes) json["holes"].push_back(points(hole));
    keep_unknown(json, old, {"from", "path", "points", "holes"});
    return json;
}

Json mesh_json(const MeshSettings& mesh, const Json* old) {
    Json json = Json::object();
    if (mesh.max_edge_px) json["max_edge_px"] = number(*mesh.max_edge_px);
    if (mesh.min_angle_deg) json["min_angle_deg"] = number(*mesh.min_angle_deg);
    if (mesh.expand_px) json["expand_px"] = number(*mesh.expand_px);
    keep_unknown(json, old, {"max_edge_px", "min_angle_deg", "expand_px"});
    return json;
}

// Writes the part of a handle that its type has.
struct ShapeWriter {
    Json& json;
    void operator()(const PointHandle& handle) const {
        json["type"] = "point";
        json["at"] = point(handle.at);
        if (handle.radius_px) json["radius_px"] = number(*handle.radius_px);
    }
    void operator()(const BoneHandle& handle) const {
        json["type"] = "bone";
        json["from"] = point(handle.from);
        json["to"] = point(handle.to);
        if (!handle.parent.empty()) json["parent"] = handle.parent;
        if (handle.length != BoneLength::stretch) json["length"] = bone_length_name(handle.length);
    }
    void operator()(const CageHandle& handle) const {
        json["type"] = "cage";
        json["points"] = points(handle.points);
    }
    void operator()(const RegionHandle& handle) const {
        json["type"] = "region";
        json["points"] = points(handle.points);
        if (handle.falloff != Falloff::none) json["falloff"] = falloff_name(handle.falloff);
    }
    void operator()(const VertexHandle& handle) const {
        json["type"] = "vertex";
        json["index"] = handle.index;
    }
};

Json handle_json(const Handle& handle, const Json* old) {
    Json json{{"id", handle.id}};
    std::visit(ShapeWriter{json}, handle.shape);
    keep_unknown(json, old,
                 {"id", "type", "at", "radius_px", "from", "to", "parent", "length", "points", "index", "falloff"});
    return json;
}

struct StiffnessWriter {
    Json operator()(const StiffnessRegion& region) const {
        return {{"points", points(region.points)}, {"value", number(region.value)}};
    }
    Json operator()(const StiffnessPicture& picture) const {
        return {{"image", picture.path}, {"max", number(picture.max)}};
    }
};

Json method_json(const MethodOptions& method, const Json* old) {
    const MethodOptions usual;
    Json json{{"name", method_name(method.method)}};
    if (method.arap_energy != usual.arap_energy) json["arap_energy"] = arap_energy_name(method.arap_energy);
    if (method.bending_length_px) json["bending_length_px"] = number(*method.bending_length_px);
    if (method.stretching != usual.stretching) json["stretching"] = number(method.stretching);
    if (method.bending != usual.bending) json["bending"] = number(method.bending);
    if (method.tolerance != usual.tolerance) json["tolerance"] = method.tolerance;
    if (method.max_iterations != usual.max_iterations) json["max_iterations"] = method.max_iterations;
    if (method.weights.kind != usual.weights.kind) json["weights"] = weight_kind_name(method.weights.kind);
    if (method.weights.partition != usual.weights.partition) {
        json["partition"] = partition_name(method.weights.partition);
    }
    if (method.weights.l1_budget != usual.weights.l1_budget) json["l1_budget"] = number(method.weights.l1_budget);
    keep_unknown(json, old,
                 {"name", "arap_energy", "bending_length_px", "stretching", "bending", "tolerance", "max_iterations",
                  "weights", "partition", "l1_budget"});
    return json;
}

Json handle_pose_json(const HandlePose& pose, const Json* old) {
    Json json = Json::object();
    if (pose.from) json["from"] = point(*pose.from);
    if (pose.to) json["to"] = point(*pose.to);
    if (pose.points) json["to"] = points(*pose.points);
    if (pose.rotate_rad) json["rotate_deg"] = degrees_number(*pose.rotate_rad);
    if (pose.turn_rad) json["turn_deg"] = degrees_number(*pose.turn_rad);
    if (pose.scale) json["scale"] = number(*pose.scale);
    if (pose.reach) json["reach"] = point(*pose.reach);
    if (pose.chain) json["chain"] = *pose.chain;
    if (pose.depth) json["depth"] = number(*pose.depth);
    if (pose.affine) {
        for (const double value : *pose.affine) json["affine"].push_back(number(value));
    }
    keep_unknown(json, old, {"from", "to", "rotate_deg", "turn_deg", "scale", "reach", "chain", "depth", "affine"});
    return json;
}

Json pose_json(const Pose& pose, const Rig& rig, const Json* old) {
    Json json{{"name", pose.name}};
    if (pose.time_s != 0 || member(old, "time_s")) json["time_s"] = number(pose.time_s);
    // In the rig's order, not the map's: the file reads as the person placed the handles.
    Json handles = Json::object();
    for (const Handle& handle : rig.handles) {
        const auto found = pose.handles.find(handle.id);
        if (found == pose.handles.end()) continue;
        handles[handle.id] = handle_pose_json(found->second, member(member(old, "handles"), handle.id.c_str()));
    }
    json["handles"] = std::move(handles);
    keep_unknown(json, old, {"name", "time_s", "handles"});
    return json;
}

}  // namespace

Json json_from_puppet(const Puppet& puppet) {
    const Json source = puppet.source.empty() ? Json::object() : parse_json(puppet.source, "puppet");
    Json json{{"format", "puppetwarp"}, {"version", 1}};
    if (!puppet.image.empty()) json["image"] = puppet.image;
    json["cutout"] = cutout_json(puppet.cutout, member(&source, "cutout"));
    if (puppet.background) json["background"] = *puppet.background;
    if (puppet.back_faces != BackFaces::hide) json["back_faces"] = back_faces_name(puppet.back_faces);
    Json mesh = mesh_json(puppet.mesh, member(&source, "mesh"));
    if (!mesh.empty()) json["mesh"] = std::move(mesh);
    json["handles"] = Json::array();
    for (const Handle& handle : puppet.rig.handles) {
        json["handles"].push_back(handle_json(handle, element(member(&source, "handles"), "id", handle.id)));
    }
    for (std::size_t i = 0; i < puppet.rig.stiffness.size(); ++i) {
        json["stiffness"].push_back(std::visit(StiffnessWriter(), puppet.rig.stiffness[i]));
        const Json* old = member(&source, "stiffness");
        keep_unknown(json["stiffness"].back(), old && old->is_array() && i < old->size() ? &(*old)[i] : nullptr,
                     {"points", "value", "image", "max"});
    }
    json["method"] = method_json(puppet.method, member(&source, "method"));
    json["poses"] = Json::array();
    for (const Pose& pose : puppet.poses) {
        json["poses"].push_back(pose_json(pose, puppet.rig, element(member(&source, "poses"), "name", pose.name)));
    }
    keep_unknown(json, &source,
                 {"format", "version", "image", "cutout", "background", "back_faces", "mesh", "handles", "stiffness",
                  "method", "poses"});
    return json;
}

}  // namespace puppetwarp
