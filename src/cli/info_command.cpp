#include "command.h"
#include "options.h"
#include "report.h"
#include "terminal.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/image/read.h>
#include <puppetwarp/mesh/distortion.h>
#include <puppetwarp/mesh/mesh_file.h>
#include <puppetwarp/project/stiffness_pictures.h>

#include <array>
#include <iostream>
#include <memory>

namespace puppetwarp::cli {

namespace {

struct InfoRequest {
    std::vector<std::string> files;
    bool json = false;
};

Json describe_picture(const std::string& file) {
    const ImageInfo info = read_image_info(file);
    return {{"file", file},
            {"kind", "picture"},
            {"format", info.format},
            {"width", info.width},
            {"height", info.height},
            {"channels", info.channels},
            {"bits", info.bits},
            {"alpha", info.has_alpha},
            {"icc", info.has_icc},
            {"exif", info.has_exif},
            {"xmp", info.has_xmp},
            {"orientation", info.orientation},
            {"pages", info.pages},
            {"x_pixels_per_mm", info.x_pixels_per_mm},
            {"y_pixels_per_mm", info.y_pixels_per_mm}};
}

Json describe_mesh(const std::string& file) {
    const TriangleMesh mesh = read_mesh(file);
    const Eigen::RowVector2d least = mesh.V.colwise().minCoeff(), most = mesh.V.colwise().maxCoeff();
    return {{"file", file},
            {"kind", "mesh"},
            {"vertices", mesh.V.rows()},
            {"triangles", mesh.F.rows()},
            {"components", vertex_components(mesh).maxCoeff() + 1},
            {"area", double_areas(mesh.V, mesh.F).sum() / 2},
            {"bounding_box",
             {{"x", least.x()}, {"y", least.y()}, {"width", most.x() - least.x()}, {"height", most.y() - least.y()}}}};
}

Json describe_puppet(const std::string& file) {
    const Puppet puppet = read_puppet(file);
    Json poses = Json::array();
    for (const Pose& pose : puppet.poses) poses.push_back(pose.name);
    Json handles = Json::object();
    constexpr std::array<const char*, 5> types{"point", "bone", "cage", "region", "vertex"};
    for (const char* type : types) handles[type] = 0;
    for (const Handle& handle : puppet.rig.handles) {
        Json& count = handles[types[handle.shape.index()]];
        count = count.get<int>() + 1;
    }
    Json json{{"file", file},
              {"kind", "puppet"},
              {"image", puppet.image},
              {"cutout", puppet.cutout.from},
              {"background", puppet.background.value_or("transparent")},
              {"method", method_name(puppet.method.method)},
              {"handles", handles},
              {"poses", poses}};
    if (puppet.image.empty()) return json;
    // Sound is what can be warped: everything but the warp itself is tried.
    const Image image = load_image(puppet);
    json["width"] = image.width();
    json["height"] = image.height();
    const Cutout cutout = cut_out_subject(puppet, image);
    const TriangleMesh mesh = mesh_subject(puppet, outline_subject(puppet, image.width(), image.height(), cutout));
    json["vertices"] = mesh.V.rows();
    json["triangles"] = mesh.F.rows();
    if (!puppet.rig.handles.empty())
        make_deformer(puppet.method, mesh, load_rig(puppet, image.width(), image.height()));
    return json;
}

Json describe(const std::string& file) {
    if (is_puppet_file(file)) return describe_puppet(file);
    const std::string extension = std::filesystem::path(file).extension().string();
    return extension == ".off" || extension == ".obj" ? describe_mesh(file) : describe_picture(file);
}

void print_for_people(const Json& description) {
    std::cout << description["file"].get<std::string>() << '\n';
    for (const auto& [key, value] : description.items()) {
        if (key == "file") continue;
        std::cout << "  " << key << std::string(key.size() < 16 ? 16 - key.size() : 1, ' ')
                  << (value.is_string() ? value.get<std::string>() : value.dump()) << '\n';
    }
}

// Files that are not sound do not keep the others from being described.
int describe_all(const InfoRequest& request) {
    int exit_code = done;
    Json descriptions = Json::array();
    for (const std::string& file : request.files) {
        try {
            descriptions.push_back(describe(file));
            if (!request.json) print_for_people(descriptions.back());
        } catch (const InvalidInput& error) {
            print_error(error.what());
            descriptions.push_back({{"file", file}, {"error", error.what()}});
            exit_code = user_error;
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
                       "puppetwarp info gingerbread.png gingerbread.puppet.json");
    const auto request = std::make_shared<InfoRequest>();
    info->add_option("files", request->files, "Pictures, meshes (.off, .obj), puppet files (.json)")
        ->required()
        ->type_name("FILE...");
    info->add_flag("--json", request->json, "Print one JSON object a file (a list for several)");
    info->callback([request, &exit_code] { exit_code = describe_all(*request); });
}

}  // namespace puppetwarp::cli
