#include "command.h"
#include "options.h"
#include "report.h"
#include "terminal.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/input_file.h>
#include <puppetwarp/image/read.h>
#include <puppetwarp/mesh/measures.h>
#include <puppetwarp/mesh/mesh_file.h>
#include <puppetwarp/project/stiffness_pictures.h>

#include <array>
#include <iostream>
#include <memory>
#include <numbers>

namespace puppetwarp::cli {

namespace {

namespace fs = std::filesystem;

struct InfoRequest {
    std::vector<std::string> files;
    bool quick = false;
    bool json = false;
};

constexpr const char* fields =
    "Report fields:\n"
    "  every file     file; kind: picture, mesh, puppet, or null for none of them; bytes;\n"
    "                 sound: whether it can be worked with, null when not tried; error:\n"
    "                 why it is not sound, else null\n"
    "  a picture      format, width, height, channels; bits a channel, 32 being float;\n"
    "                 alpha, icc, exif, xmp: whether it has them; orientation: EXIF, 1 to\n"
    "                 8, width and height being after it; pages; x_pixels_per_mm and\n"
    "                 y_pixels_per_mm, 0 when it does not say\n"
    "  a mesh         format, vertices, triangles, edges, boundary_edges, components,\n"
    "                 clockwise, area, longest_edge, smallest_angle_deg, bounding_box: x,\n"
    "                 y, width, height\n"
    "  a puppet file  version, image, cutout, background, method; handles: how many of\n"
    "                 each type; handle_ids, poses: their names; stiffness: how many;\n"
    "                 files: what it needs, seen from here; width and height of its\n"
    "                 picture, vertices and triangles of its mesh, null without a picture";

void describe_picture(const std::string& file, const InfoRequest& request, Json& json) {
    const ImageInfo info = read_image_info(file);
    json["kind"] = "picture";
    json["format"] = info.format;
    json["width"] = info.width;
    json["height"] = info.height;
    json["channels"] = info.channels;
    json["bits"] = info.bits;
    json["alpha"] = info.has_alpha;
    json["icc"] = info.has_icc;
    json["exif"] = info.has_exif;
    json["xmp"] = info.has_xmp;
    json["orientation"] = info.orientation;
    json["pages"] = info.pages;
    json["x_pixels_per_mm"] = info.x_pixels_per_mm;
    json["y_pixels_per_mm"] = info.y_pixels_per_mm;
    if (request.quick) {
        json["sound"] = nullptr;
    } else {
        read_image(file);  // a header promises more than the rest may hold
    }
}

void describe_mesh(const std::string& file, Json& json) {
    json["kind"] = "mesh";
    const TriangleMesh mesh = read_mesh(file);
    const MeshMeasures measures = measure_mesh(mesh);
    const Eigen::RowVector2d least = mesh.V.colwise().minCoeff(), most = mesh.V.colwise().maxCoeff();
    json["format"] = lower_extension(file).substr(1);
    json["vertices"] = mesh.V.rows();
    json["triangles"] = mesh.F.rows();
    json["edges"] = measures.edges;
    json["boundary_edges"] = measures.boundary_edges;
    json["components"] = measures.components;
    json["clockwise"] = measures.clockwise;
    json["area"] = measures.area;
    json["longest_edge"] = measures.longest_edge;
    json["smallest_angle_deg"] = measures.smallest_angle_rad * 180 / std::numbers::pi;
    json["bounding_box"] = {
        {"x", least.x()}, {"y", least.y()}, {"width", most.x() - least.x()}, {"height", most.y() - least.y()}};
}

// What the file itself says.
void describe_document(const std::string& file, const Puppet& puppet, Json& json) {
    json["version"] = 1;
    json["image"] = puppet.image.empty() ? Json(nullptr) : Json(puppet.image);
    json["cutout"] = puppet.cutout.from;
    json["background"] = puppet.background.value_or("transparent");
    json["method"] = method_name(puppet.method.method);
    constexpr std::array<const char*, 5> types{"point", "bone", "cage", "region", "vertex"};
    std::array<int, types.size()> counts{};
    json["handles"] = Json::object();
    json["handle_ids"] = Json::array();
    for (const Handle& handle : puppet.rig.handles) {
        ++counts[handle.shape.index()];
        json["handle_ids"].push_back(handle.id);
    }
    for (std::size_t i = 0; i < types.size(); ++i) json["handles"][types[i]] = counts[i];
    json["poses"] = Json::array();
    for (const Pose& pose : puppet.poses) json["poses"].push_back(pose.name);
    json["stiffness"] = puppet.rig.stiffness.size();
    json["files"] = Json::array();
    const std::vector<fs::path> files = input_files(file, puppet);
    for (std::size_t i = 1; i < files.size(); ++i) json["files"].push_back(files[i].string());
    for (const char* key : {"width", "height", "vertices", "triangles"}) json[key] = nullptr;
}

void describe_puppet(const std::string& file, Json& json) {
    json["kind"] = "puppet";
    const Puppet puppet = read_puppet(file);
    describe_document(file, puppet, json);
    if (puppet.image.empty()) return;
    // Sound is what can be warped: everything but the warp itself is tried.
    const Image image = load_image(puppet);
    json["width"] = image.width();
    json["height"] = image.height();
    const Cutout cutout = cut_out_subject(puppet, image);
    const TriangleMesh mesh = mesh_subject(puppet, outline_subject(puppet, image.width(), image.height(), cutout));
    json["vertices"] = mesh.V.rows();
    json["triangles"] = mesh.F.rows();
    if (puppet.rig.handles.empty()) return;
    make_deformer(puppet.method, mesh, load_rig(puppet, image.width(), image.height()));
}

// What this program writes and others read.
void refuse_results(const std::string& file) {
    const std::string extension = lower_extension(file);
    if (extension == ".csv" || extension == ".dmat") {
        throw InvalidInput(file, "is a table of numbers, which puppetwarp writes and does not read",
                           "name a picture, a mesh or a puppet file");
    }
    if (extension == ".weights") {
        throw InvalidInput(file, "keeps the weights of a puppet file from run to run, and can be deleted",
                           "name the puppet file");
    }
}

Json describe(const std::string& file, const InfoRequest& request) {
    Json json{{"file", file}, {"kind", nullptr}, {"bytes", nullptr}, {"sound", false}, {"error", nullptr}};
    try {
        require_readable_file(file);
        json["bytes"] = fs::file_size(file);
        json["sound"] = true;
        if (is_puppet_file(file)) {
            describe_puppet(file, json);
        } else if (is_mesh_file(file)) {
            describe_mesh(file, json);
        } else {
            refuse_results(file);
            describe_picture(file, request, json);
        }
    } catch (const InvalidInput& error) {
        json["sound"] = false;
        json["error"] = error.what();
    }
    return json;
}

void print_for_people(const Json& description) {
    std::cout << description["file"].get<std::string>() << '\n';
    for (const auto& [key, value] : description.items()) {
        if (key == "file" || value.is_null()) continue;
        std::cout << "  " << key << std::string(key.size() < 19 ? 19 - key.size() : 1, ' ')
                  << (value.is_string() ? value.get<std::string>()
                                        : value.dump(-1, ' ', false, Json::error_handler_t::replace))
                  << '\n';
    }
}

// Files that are not sound do not keep the others from being described.
int describe_all(const InfoRequest& request) {
    int exit_code = done;
    Json descriptions = Json::array();
    for (const std::string& file : request.files) {
        descriptions.push_back(describe(file, request));
        const Json& description = descriptions.back();
        if (!description["error"].is_null()) {
            print_error(description["error"]);
            exit_code = user_error;
        } else if (!request.json) {
            print_for_people(description);
        }
    }
    if (request.json) {
        const Json& result = request.files.size() == 1 ? descriptions[0] : descriptions;
        std::cout << result.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
    }
    return exit_code;
}

}  // namespace

void add_info_command(CLI::App& app, const GlobalOptions& /*global*/, int& exit_code) {
    CLI::App* info =
        add_subcommand(app, "info", "Tell what pictures, meshes and puppet files hold, and whether they are sound",
                       "puppetwarp info gingerbread.png gingerbread.puppet.json\n"
                       "  puppetwarp info --json *.png > pictures.json");
    info->footer(info->get_footer() + "\n\n" + fields);
    const auto request = std::make_shared<InfoRequest>();
    info->add_option("files", request->files, "Pictures, meshes (.off, .obj), puppet files (.json)")
        ->required()
        ->type_name("FILE...");
    info->add_flag("--quick", request->quick, "Read only the headers of pictures, which may promise what is not there");
    info->add_flag("--json", request->json, "Print one JSON object a file (a list for several)");
    info->callback([request, &exit_code] { exit_code = describe_all(*request); });
}

}  // namespace puppetwarp::cli
