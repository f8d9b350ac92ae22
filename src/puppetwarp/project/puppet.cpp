#include <puppetwarp/project/puppet.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/input_file.h>
#include <puppetwarp/base/output_file.h>
#include <puppetwarp/project/json_schema.h>
#include <puppetwarp/project/puppet_json.h>

#include <algorithm>

namespace puppetwarp {

namespace fs = std::filesystem;

namespace {

// A puppet file holds choices, not pixels: more than this is something else.
constexpr std::size_t max_puppet_bytes = 64u << 20;

// Where `path`, which is relative to `from`, is seen from `to`. Absolute paths stay.
std::string moved_path(const std::string& path, const fs::path& from, const fs::path& to) {
    if (path.empty() || fs::path(path).is_absolute()) return path;
    const fs::path base = fs::weakly_canonical(fs::absolute(from.empty() ? fs::path(".") : from));
    const fs::path target = fs::weakly_canonical(fs::absolute(to.empty() ? fs::path(".") : to));
    if (base == target) return path;
    return (base / path).lexically_normal().lexically_relative(target).generic_string();
}

// Short lists of numbers stay on one line: a point is one thing, and a moved point is one changed line.
std::string dump(const Json& json, int indent) {
    const std::string pad(static_cast<std::size_t>(indent) + 2, ' ');
    std::string flat = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (!json.is_structured() || json.empty()) return flat;
    const bool numbers =
        json.is_array() && std::all_of(json.begin(), json.end(), [](const Json& value) {
            return value.is_number() || (value.is_array() && std::all_of(value.begin(), value.end(),
                                                                         [](const Json& v) { return v.is_number(); }));
        });
    std::string text;
    if (numbers) {
        for (const Json& value : json)
            text += (text.empty() ? "" : ", ") + (value.is_array() ? dump(value, 0) : value.dump());
        return "[" + text + "]";
    }
    for (const auto& [key, value] : json.items()) {
        text += text.empty() ? "" : ",\n";
        text += pad + (json.is_object() ? Json(key).dump(-1, ' ', false, Json::error_handler_t::replace) + ": " : "");
        text += dump(value, indent + 2);
    }
    const std::string end = "\n" + std::string(static_cast<std::size_t>(indent), ' ');
    return json.is_object() ? "{\n" + text + end + "}" : "[\n" + text + end + "]";
}

}  // namespace

Puppet parse_puppet(std::string_view text, const std::string& subject, const fs::path& folder) {
    const Json json = parse_json(text, subject);
    const JsonReader document(json, subject);
    Puppet puppet = puppet_from_json(document);
    // Its own complaints are the better ones; what it lets pass is held against what `puppet_schema` promises.
    if (const std::string fault = schema_fault(json, json_of_puppet_schema()); !fault.empty()) document.fail(fault);
    puppet.folder = folder;
    puppet.source = text;
    return puppet;
}

Puppet read_puppet(const fs::path& path) {
    return parse_puppet(read_file(path, max_puppet_bytes), path.string(), path.parent_path());
}

std::string to_json(const Puppet& puppet) {
    return dump(json_from_puppet(puppet), 0) + "\n";
}

void write_puppet(const Puppet& puppet, const fs::path& path) {
    Puppet moved = puppet;
    moved.image = moved_path(puppet.image, puppet.folder, path.parent_path());
    moved.cutout.path = moved_path(puppet.cutout.path, puppet.folder, path.parent_path());
    for (Stiffness& stiffness : moved.rig.stiffness) {
        auto* picture = std::get_if<StiffnessPicture>(&stiffness);
        if (picture != nullptr) picture->path = moved_path(picture->path, puppet.folder, path.parent_path());
    }
    write_file(path, to_json(moved));
}

fs::path resolve(const Puppet& puppet, const std::string& path) {
    return puppet.folder / path;
}

Pose find_pose(const Puppet& puppet, const std::string& name) {
    if (name == "rest") return Pose{"rest", 0, {}};
    std::string names = "rest";
    for (const Pose& pose : puppet.poses) {
        if (pose.name == name) return pose;
        names += ", " + pose.name;
    }
    throw InvalidInput("pose '" + name + "'", "the puppet has no such pose", "it has: " + names);
}

Pose default_pose(const Puppet& puppet) {
    return puppet.poses.empty() ? find_pose(puppet, "rest") : puppet.poses.front();
}

}  // namespace puppetwarp
