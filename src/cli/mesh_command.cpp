#include "command.h"
#include "options.h"
#include "terminal.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/image/write.h>
#include <puppetwarp/mesh/mesh_file.h>
#include <puppetwarp/project/overlay.h>

#include <cstdio>
#include <memory>

namespace puppetwarp::cli {

namespace {

struct MeshRequest {
    std::string input;
    std::string output;
    std::optional<double> max_edge_px;
    std::optional<double> min_angle_deg;
    std::optional<double> expand_px;
    std::int64_t max_pixels = ReadOptions().max_pixels;
    bool force = false;
};

void apply(const MeshRequest& request, MeshSettings& mesh) {
    if (request.max_edge_px) mesh.max_edge_px = request.max_edge_px;
    if (request.min_angle_deg) mesh.min_angle_deg = request.min_angle_deg;
    if (request.expand_px) mesh.expand_px = request.expand_px;
}

// The mesh drawn over the picture it was made from.
void write_mesh_picture(const Image& image, const TriangleMesh& mesh, const std::string& output) {
    Image picture{image.pixels.clone(), image.metadata};
    draw_mesh(picture, mesh.V, mesh.F, {0, 0, image.width(), image.height()});
    write_image(picture, output);
}

int make_mesh(const MeshRequest& request, const GlobalOptions& global) {
    const std::string extension = std::filesystem::path(request.output).extension().string();
    if (extension != ".off" && extension != ".obj" && extension != ".svg" && extension != ".png") {
        throw InvalidInput(request.output, "the extension says no format of a mesh", "use .off, .obj, .svg or .png");
    }
    Puppet puppet = open_puppet(request.input);
    apply(request, puppet.mesh);
    require_good_outputs({input_files(request.input, puppet), {request.output}}, request.force);
    const ReadOptions read{request.max_pixels};
    const Image image = load_image(puppet, read);
    const Cutout cutout = cut_out_subject(puppet, image, read);
    const TriangleMesh mesh = mesh_subject(puppet, outline_subject(puppet, image.width(), image.height(), cutout));

    if (extension == ".png") {
        write_mesh_picture(image, mesh, request.output);
    } else if (extension == ".svg") {
        DrawingArea area;
        area.width = image.width();
        area.height = image.height();
        write_mesh_svg(mesh, area, request.output);
    } else {
        write_mesh(mesh, request.output, texture_coordinates(mesh.V, image.width(), image.height()));
    }
    if (!global.quiet) {
        std::fprintf(stderr, "%d vertices, %d triangles\n", static_cast<int>(mesh.V.rows()),
                     static_cast<int>(mesh.F.rows()));
    }
    return done;
}

}  // namespace

void add_mesh_command(CLI::App& app, const GlobalOptions& global, int& exit_code) {
    CLI::App* mesh = add_subcommand(app, "mesh", "Triangulate the silhouette of a picture",
                                    "puppetwarp mesh gingerbread.png -o gingerbread.svg --max-edge-px 20");
    const auto request = std::make_shared<MeshRequest>();
    mesh->add_option("input", request->input, "A picture, or a puppet file (.json)")
        ->required()
        ->type_name("IMAGE|PUPPET");
    mesh->add_option("-o,--output", request->output, "The mesh (.off, .obj) or a drawing of it (.svg, .png)")
        ->required()
        ->type_name("OUT");
    mesh->add_option("--max-edge-px", request->max_edge_px, "Longest edge (default: a share of the subject's size)")
        ->type_name("N")
        ->check(above_zero());
    mesh->add_option("--min-angle-deg", request->min_angle_deg, "Smallest angle, 0 to 30 (default 25)")->type_name("N");
    mesh->add_option("--expand-px", request->expand_px, "How far to grow the outline (default 2)")
        ->type_name("N")
        ->check(not_negative());
    mesh->add_option("--max-pixels", request->max_pixels, "Refuse larger pictures (default 200000000)")
        ->type_name("N")
        ->check(above_zero());
    mesh->add_flag("--force", request->force, "Let the output replace the input");
    mesh->callback([request, &global, &exit_code] { exit_code = make_mesh(*request, global); });
}

}  // namespace puppetwarp::cli
