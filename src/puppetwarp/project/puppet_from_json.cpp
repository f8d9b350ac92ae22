#include <puppetwarp/project/puppet_json.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/warp/background.h>

#include <limits>
#include <numbers>

namespace puppetwarp {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double radians(double degrees) {
    return degrees * std::numbers::pi / 180;
}

CutoutSettings read_cutout(const JsonReader& json) {
    CutoutSettings cutout;
    if (const auto from = json.find("from")) {
        cutout.from = from->text();
        if (cutout.from == "colour" || cutout.from == "grabcut") {
            from->fail("`" + cutout.from + "` is not supported by this version", "use mask or polygon");
        }
        if (cutout.from != "auto" && cutout.from != "alpha" && cutout.from != "mask" && cutout.from != "polygon" &&
            cutout.from != "whole") {
            from->fail("`" + cutout.from + "` is unknown", "use auto, alpha, mask, polygon or whole");
        }
    }
    if (const auto path = json.find("path")) cutout.path = path->text();
    if (cutout.from == "mask" && cutout.path.empty()) json.fail("lacks the field `path`", "name the mask's picture");
    if (const auto points = json.find("points")) cutout.points = points->points(3);
    if (cutout.from == "polygon" && cutout.points.empty()) json.fail("lacks the field `points`");
    if (const auto holes = json.find("holes")) {
        for (const JsonReader& hole : holes->elements()) cutout.holes.push_back(hole.points(3));
    }
    return cutout;
}

MeshSettings read_mesh_settings(const JsonReader& json) {
    MeshSettings mesh;
    if (const auto value = json.find("max_edge_px")) mesh.max_edge_px = value->positive();
    if (const auto value = json.find("min_angle_deg")) mesh.min_angle_deg = value->number_in(0, 30);
    if (const auto value = json.find("expand_px")) mesh.expand_px = value->number_in(0, infinity);
    return mesh;
}

// The library's own complaint about a name lists the known ones; the field is added to it here.
template <typename FromName>
auto named(const JsonReader& field, FromName from_name) {
    const std::string text = field.text();
    try {
        return from_name(text);
    } catch (const InvalidInput& error) {
        field.fail("'" + text + "': " + error.reason(), error.advice());
    }
}

Handle read_handle(const JsonReader& json) {
    Handle handle;
    handle.id = json.at("id").text();
    const JsonReader type = json.at("type");
    const std::string name = type.text();
    if (name == "point") {
        PointHandle point{json.at("at").point(), std::nullopt};
        if (const auto radius = json.find("radius_px")) point.radius_px = radius->positive();
        handle.shape = point;
    } else if (name == "bone") {
        const auto parent = json.find("parent");
        BoneHandle bone{json.at("from").point(), json.at("to").point(), parent ? parent->text() : ""};
        if (const auto length = json.find("length")) bone.length = named(*length, bone_length_from_name);
        handle.shape = std::move(bone);
    } else if (name == "cage") {
        handle.shape = CageHandle{json.at("points").points(3)};
    } else if (name == "region") {
        RegionHandle region{json.at("points").points(3)};
        if (const auto falloff = json.find("falloff")) region.falloff = named(*falloff, falloff_from_name);
        handle.shape = std::move(region);
    } else if (name == "vertex") {
        handle.shape = VertexHandle{json.at("index").integer()};
    } else {
        type.fail("`" + name + "` is unknown", "use point, bone, cage, region or vertex");
    }
    return handle;
}

Stiffness read_stiffness(const JsonReader& json) {
    if (const auto image = json.find("image")) {
        StiffnessPicture picture;
        picture.path = image->text();
        if (picture.path.empty()) image->fail("must name a picture");
        picture.max = json.at("max").positive();
        return picture;
    }
    return StiffnessRegion{json.at("points").points(3), json.at("value").positive()};
}

MethodOptions read_method(const JsonReader& json) {
    MethodOptions method;
    if (const auto name = json.find("name")) method.method = named(*name, method_from_name);
    if (const auto energy = json.find("arap_energy")) method.arap_energy = named(*energy, arap_energy_from_name);
    if (const auto length = json.find("bending_length_px")) method.bending_length_px = length->positive();
    if (const auto stretching = json.find("stretching")) method.stretching = stretching->number_in(0, infinity);
    if (const auto bending = json.find("bending")) method.bending = bending->number_in(0, infinity);
    if (const auto tolerance = json.find("tolerance")) method.tolerance = tolerance->positive();
    if (const auto most = json.find("max_iterations")) {
        method.max_iterations = most->integer();
        if (method.max_iterations < 1) most->fail("must be at least 1");
    }
    if (const auto kind = json.find("weights")) method.weights.kind = named(*kind, weight_kind_from_name);
    if (const auto partition = json.find("partition")) {
        method.weights.partition = named(*partition, partition_from_name);
    }
    if (const auto budget = json.find("l1_budget")) {
        method.weights.l1_budget = budget->number_in(0, 1);
        if (!(method.weights.l1_budget > 0)) budget->fail("must be above 0");
    }
    return method;
}

HandlePose read_handle_pose(const JsonReader& json, const Handle& handle) {
    HandlePose pose;
    if (const auto to = json.find("to")) {
        if (std::holds_alternative<CageHandle>(handle.shape)) {
            const std::size_t corners = std::get<CageHandle>(handle.shape).points.size();
            pose.points = to->points(corners);
            if (pose.points->size() != corners) to->fail("must hold " + std::to_string(corners) + " points");
        } else {
            pose.to = to->point();
        }
    }
    if (const auto from = json.find("from")) pose.from = from->point();
    if (const auto rotate = json.find("rotate_deg")) pose.rotate_rad = radians(rotate->number());
    if (const auto turn = json.find("turn_deg")) pose.turn_rad = radians(turn->number());
    if (const auto scale = json.find("scale")) pose.scale = scale->positive();
    if (const auto reach = json.find("reach")) pose.reach = reach->point();
    if (const auto chain = json.find("chain")) {
        pose.chain = chain->integer();
        if (*pose.chain < 1) chain->fail("must be at least 1");
    }
    if (const auto depth = json.find("depth")) pose.depth = depth->number();
    if (const auto affine = json.find("affine")) pose.affine = affine->affine();
    return pose;
}

Pose read_pose(const JsonReader& json, const Rig& rig) {
    Pose pose;
    const JsonReader name = json.at("name");
    pose.name = name.text();
    if (pose.name.empty()) name.fail("must not be empty");
    if (pose.name == "rest") name.fail("must not be `rest`", "that name is kept for the rest pose");
    if (const auto time = json.find("time_s")) pose.time_s = time->number();
    if (const auto handles = json.find("handles")) {
        for (const auto& [id, targets] : handles->members()) {
            const Handle* handle = find_handle(rig, id);
            if (!handle) targets.fail("is no handle of this puppet");
            pose.handles.emplace(id, read_handle_pose(targets, *handle));
        }
    }
    return pose;
}

void require_version(const JsonReader& document) {
    const JsonReader format = document.at("format");
    if (format.text() != "puppetwarp") format.fail("must be \"puppetwarp\"", "this is not a puppet file");
    const JsonReader version = document.at("version");
    if (const double number = version.number(); number != 1) {
        version.fail("is " + short_number(number) + ", but this program reads version 1", "use a newer puppetwarp");
    }
}

// Errors that the rig finds name the handle; the document is put before them.
template <typename Check>
void checked(const JsonReader& document, Check check) {
    try {
        check();
    } catch (const InvalidInput& error) {
        document.fail(error.subject() + ": " + error.reason(), error.advice());
    }
}

}  // namespace

Puppet puppet_from_json(const JsonReader& document) {
    require_version(document);
    Puppet puppet;
    if (const auto image = document.find("image")) puppet.image = image->text();
    if (const auto cutout = document.find("cutout")) puppet.cutout = read_cutout(*cutout);
    if (const auto background = document.find("background")) {
        puppet.background = background->text();
        try {
            background_from_name(*puppet.background);
        } catch (const InvalidInput& error) {
            background->fail(error.reason(), error.advice());
        }
    }
    if (const auto faces = document.find("back_faces")) puppet.back_faces = named(*faces, back_faces_from_name);
    if (const auto mesh = document.find("mesh")) puppet.mesh = read_mesh_settings(*mesh);
    if (const auto handles = document.find("handles")) {
        for (const JsonReader& handle : handles->elements()) puppet.rig.handles.push_back(read_handle(handle));
    }
    if (const auto stiffness = document.find("stiffness")) {
        for (const JsonReader& region : stiffness->elements()) puppet.rig.stiffness.push_back(read_stiffness(region));
    }
    checked(document, [&] { require_sound(puppet.rig); });
    if (const auto method = document.find("method")) puppet.method = read_method(*method);
    if (const auto poses = document.find("poses")) {
        for (const JsonReader& json : poses->elements()) {
            Pose pose = read_pose(json, puppet.rig);
            for (const Pose& other : puppet.poses) {
                if (other.name == pose.name) json.fail("has the name `" + pose.name + "` of another pose");
            }
            checked(json, [&] { require_sound(pose, puppet.rig); });
            puppet.poses.push_back(std::move(pose));
        }
    }
    return puppet;
}

}  // namespace puppetwarp
