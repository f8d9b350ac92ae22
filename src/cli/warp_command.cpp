#include "command.h"
#include "option_table.h"
#include "options.h"
#include "report.h"
#include "terminal.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/image/write.h>
#include <puppetwarp/project/overlay.h>
#include <puppetwarp/project/rendered_files.h>
#include <puppetwarp/warp/background.h>
#include <puppetwarp/warp/displacement_file.h>

#include <algorithm>
#include <memory>
#include <optional>

namespace puppetwarp::cli {

namespace {

// What `warp` was asked for, as typed.
struct WarpRequest {
    std::string input;
    std::string output;
    std::string image;
    std::string displacement;
    std::string displacement_in;
    std::string mesh_out;
    double scale = 1;
    std::vector<std::string> pins;
    std::optional<std::string> pose;
    std::optional<std::string> method;
    std::optional<std::string> arap_energy;
    WeightChoice weights;
    HandleChoice handles;
    std::optional<std::string> canvas;
    std::string interpolation = "bicubic";
    bool linear = false;
    std::optional<std::string> background;
    std::optional<std::string> back_faces;
    std::vector<std::string> overlay;
    std::int64_t max_pixels = ReadOptions().max_pixels;
    double pin_snap_px = 0;
    int compression = WriteOptions().compression;
    int quality = WriteOptions().quality;
    GateOptions gates;
    bool strict = false;
    bool force = false;
    ReportOptions report;

    bool wants_overlay(const char* what) const { return std::count(overlay.begin(), overlay.end(), what) > 0; }
};

// The command line's wishes laid over what the file says.
void apply(const WarpRequest& request, Puppet& puppet, Pose& pose) {
    if (request.method) puppet.method.method = method_from_name(*request.method);
    if (request.arap_energy) puppet.method.arap_energy = arap_energy_from_name(*request.arap_energy);
    puppet.method.weights = request.weights.options(puppet.method.weights);
    if (request.background) {
        background_from_name(*request.background);  // complains before any work
        puppet.background = request.background;
    }
    if (request.back_faces) puppet.back_faces = back_faces_from_name(*request.back_faces);
    add_pins(puppet, pose, request.pins);
    require_sound(puppet.rig);
}

// The pose of the pins in place of the one that it began as, or after the others.
void keep_pose(Puppet& puppet, const Pose& pose) {
    if (pose.handles.empty()) return;
    const auto same = std::find_if(puppet.poses.begin(), puppet.poses.end(),
                                   [&](const Pose& other) { return other.name == pose.name; });
    if (same == puppet.poses.end()) {
        puppet.poses.push_back(pose);
    } else {
        *same = pose;
    }
}

std::string join(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

void tell_what_is_lost(const WarpRequest& request, const RenderReport& report, bool quiet) {
    if (report.lost.empty()) return;
    const std::string message = "this format cannot hold " + join(report.lost);
    if (request.strict) {
        throw InvalidInput(request.output, message, "use .png or .tif, or leave --strict away");
    }
    if (!quiet) print_warning(request.output + ": " + message);
}

void warn_about_result(const RenderReport& report, BackFaces back_faces, bool quiet) {
    if (quiet) return;
    print_warnings(report);
    const auto folded = report.distortion.flipped_triangles;
    if (folded > 0) {
        print_warning(std::to_string(folded) + (folded == 1 ? " triangle is" : " triangles are") + " folded over and " +
                      (back_faces == BackFaces::hide ? "not drawn" : "drawn mirrored") + " (pull less, or add a pin)");
    }
}

RenderOptions render_options(const WarpRequest& request) {
    RenderOptions options;
    options.read.max_pixels = request.max_pixels;
    options.image = request.image;
    options.scale = request.scale;
    options.interpolation = interpolation_from_name(request.interpolation);
    options.linear = request.linear;
    if (request.canvas) options.canvas = parse_canvas(*request.canvas);
    options.automatic_cage = request.handles.automatic_cage;
    options.pin_snap_px = request.pin_snap_px;
    options.weights_cache = request.weights.cache_beside(request.input);
    options.format = output_format(request.output);
    options.in_rows = request.overlay.empty();
    options.keep_source = !request.displacement.empty() || !request.mesh_out.empty();
    return options;
}

// Files whose names say nothing of their format are refused before any work.
void require_names(const WarpRequest& request) {
    if (!request.displacement.empty()) require_displacement_name(request.displacement);
    if (!request.mesh_out.empty()) require_moved_mesh_name(request.mesh_out);
}

Files files_of(const WarpRequest& request, std::vector<std::filesystem::path> inputs) {
    inputs.emplace_back(request.image);
    inputs.emplace_back(request.displacement_in);
    return {std::move(inputs),
            {request.output, request.displacement, request.mesh_out, request.report.file, request.handles.save_puppet},
            request.report.json};
}

// The picture and what was asked for beside it; `write` of the timings is all of it.
void write_files(const WarpRequest& request, const RenderOptions& options, Rendered& rendered, Progress& progress) {
    const auto start = std::chrono::steady_clock::now();
    const WriteOptions writing{request.compression, request.quality};
    if (!request.displacement.empty())
        write_displacement(displacement_of(rendered, options), request.displacement, writing, progress);
    if (!request.mesh_out.empty()) write_moved_mesh(rendered, request.mesh_out);
    if (options.in_rows) {
        write_rows(rendered.rows, request.output, writing);
    } else {
        write_image(rendered.image, request.output, writing);
    }
    std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    auto& timings = rendered.report.timings_ms;
    if (options.in_rows) {
        timings.back().second += *rendered.rows_ms;  // the warp's
        took -= std::chrono::duration<double, std::milli>(*rendered.rows_ms);
    }
    timings.emplace_back("write", took.count());
}

int finish(const WarpRequest& request, const RenderReport& report, const GlobalOptions& global) {
    request.report.emit(report_json(report, true));
    if (global.verbose) {
        print_timings(report.timings_ms);
        if (report.max_magnification > 0)
            std::fprintf(stderr, "magnified at most %.2f times\n", report.max_magnification);
    }
    return request.gates.hold(report.distortion) ? done : answer_is_no;
}

int warp_picture(const WarpRequest& request, const GlobalOptions& global) {
    const RenderOptions options = render_options(request);
    require_names(request);
    Puppet puppet = open_puppet(request.input);
    Pose pose = request.pose ? find_pose(puppet, *request.pose) : default_pose(puppet);
    apply(request, puppet, pose);
    require_good_outputs(files_of(request, input_files(request.input, puppet)), request.force);

    ProgressBar progress(global.quiet);
    Rendered rendered = render(puppet, pose, options, progress);
    tell_what_is_lost(request, rendered.report, global.quiet);
    warn_about_result(rendered.report, puppet.back_faces, global.quiet);
    if (request.wants_overlay("mesh")) draw_mesh(rendered);
    if (request.wants_overlay("handles")) draw_handles(rendered, pose);
    write_files(request, options, rendered, progress);
    if (!request.pins.empty()) keep_pose(puppet, pose);
    request.handles.save(puppet, rendered.rig);
    return finish(request, rendered.report, global);
}

int warp_through_map(const WarpRequest& request, const GlobalOptions& global) {
    RenderOptions options = render_options(request);
    if (!request.canvas) options.canvas.kind = CanvasChoice::Kind::of_map;
    const std::string background = request.background.value_or("transparent");
    background_from_name(background);  // complains before any work
    if (is_puppet_file(request.input)) {
        throw InvalidInput(request.input, "is a puppet file, and a displacement map holds all of the deformation",
                           "give the picture");
    }
    require_good_outputs(files_of(request, {request.input}), request.force);

    ProgressBar progress(global.quiet);
    Rendered rendered = render_through(request.input, request.displacement_in, background, options, progress);
    tell_what_is_lost(request, rendered.report, global.quiet);
    if (!global.quiet) print_warnings(rendered.report);
    write_files(request, options, rendered, progress);
    return finish(request, rendered.report, global);
}

void add_method_options(CLI::App& warp, WarpRequest& request) {
    warp.add_option("--pin", request.pins,
                    "A pin: X,Y holds a place, X,Y:X2,Y2 moves it, @DEG turns it; again for more pins")
        ->type_name("X,Y[:X2,Y2][@DEG]")
        ->allow_extra_args(false);
    warp.add_option("--pose", request.pose, "A pose of the puppet file (default: its first); rest: the rest pose")
        ->type_name("NAME");
    warp.add_option("--method", request.method,
                    "How the mesh follows: " + method_list() + " (default: the puppet file's, else arap)")
        ->type_name("M")
        ->check(completed_by(method_names()));
    warp.add_option("--arap-energy", request.arap_energy, "elements (default), spokes, spokes-and-rims")
        ->type_name("E")
        ->check(completed_by(arap_energy_names()));
    request.weights.add_to(warp, "--weights");
    request.handles.add_to(warp);
    warp.add_option("--pin-snap", request.pin_snap_px, "Move pins at most PX pixels outside the subject onto it")
        ->type_name("PX")
        ->check(not_negative());
}

void add_picture_options(CLI::App& warp, WarpRequest& request) {
    warp.add_option(
            "--image", request.image,
            "Draw this picture instead of the puppet's, at any resolution; coordinates stay those of the puppet's")
        ->type_name("PICTURE")
        ->check(not_empty());
    warp.add_option("--canvas", request.canvas,
                    "keep (default), grow so that nothing is cut off, or WxH+X+Y in pixels before --scale")
        ->type_name("C")
        ->check(completed_by({"keep", "grow"}));
    warp.add_option("--scale", request.scale,
                    "Pixels of the result for one of the picture, along each axis (default 1)")
        ->type_name("S")
        ->check(above_zero());
    warp.add_option("--interpolation", request.interpolation, "nearest, bilinear, bicubic (default), lanczos3")
        ->type_name("I")
        ->check(completed_by(interpolation_names()));
    warp.add_flag("--linear", request.linear,
                  "Blend in linear light, by the tone curves of the picture's profile, else sRGB's");
    warp.add_option("--background", request.background, "transparent (default), keep, inpaint, #rrggbb or #rrggbbaa")
        ->type_name("B")
        ->check(completed_by({"transparent", "keep", "inpaint"}));
    warp.add_option("--back-faces", request.back_faces,
                    "Triangles that are folded over: hide (default) or show, mirrored")
        ->type_name("F")
        ->check(completed_by({"hide", "show"}));
    warp.add_option("--overlay", request.overlay, "Draw over the result: mesh, handles or both")
        ->type_name("mesh,handles")
        ->delimiter(',')
        ->check(CLI::IsMember({"mesh", "handles"}))
        ->allow_extra_args(false);
    warp.add_option("--compression", request.compression, "Of PNG and TIFF, 0 fast to 9 small (default 1)")
        ->type_name("N")
        ->check(CLI::Range(0, 9));
    warp.add_option("--quality", request.quality, "Of JPEG and WebP, 1 to 100 (default 95)")
        ->type_name("N")
        ->check(CLI::Range(1, 100));
    warp.add_option("--max-pixels", request.max_pixels, "Refuse larger pictures (default 200000000)")
        ->type_name("N")
        ->check(above_zero());
}

// What the deformation is written to and read from as data.
void add_data_options(CLI::App& warp, WarpRequest& request) {
    warp.add_option(
            "--displacement", request.displacement,
            "Write the deformation as an ST map of 32-bit floats (.exr, .tif): red x / width, green 1 - y / height "
            "of the place in the picture that a pixel shows, blue and alpha 1 where there is one. EXR has "
            "displacement.x and displacement.y too: pixels to that place, right and up")
        ->type_name("OUT")
        ->check(not_empty());
    warp.add_option("--mesh-out", request.mesh_out,
                    "Write the moved mesh: .off, .obj with texture coordinates, or .svg over the result")
        ->type_name("OUT")
        ->check(not_empty());
    warp.add_option("--displacement-in", request.displacement_in,
                    "Draw the picture through an ST map (.exr, .tif, or any picture of 16 or 32 bits) instead of pins; "
                    "--canvas is all that the map holds by default")
        ->type_name("MAP")
        ->check(not_empty());
}

// A map holds all of the deformation: there is nothing for pins, methods and meshes to do.
void require_map_alone(const CLI::App& warp) {
    for (const char* other : {"--pin", "--pose", "--method", "--arap-energy", "--weights", "--partition", "--l1-budget",
                              "--no-cache", "--auto-cage", "--save-puppet", "--pin-snap", "--overlay", "--image",
                              "--back-faces", "--displacement", "--mesh-out", "--fail-on-fold", "--fail-on-stretch"}) {
        if (warp.count(other) == 0) continue;
        throw InvalidInput("usage", std::string("--displacement-in leaves nothing to do for ") + other,
                           "leave one of them away");
    }
}

}  // namespace

void add_warp_command(CLI::App& app, const GlobalOptions& global, int& exit_code) {
    CLI::App* warp = add_subcommand(app, "warp", "Warp a picture through pins or a puppet file",
                                    "puppetwarp warp photo.jpg --pin 100,200 --pin 320,90:360,40 -o out.jpg\n"
                                    "  puppetwarp warp gingerbread.puppet.json --pose wave -o wave.png\n"
                                    "  puppetwarp warp photo.jpg --displacement-in map.exr -o out.jpg");
    const auto request = std::make_shared<WarpRequest>();
    warp->add_option("input", request->input, "A picture, or a puppet file (.json)")
        ->required()
        ->type_name("IMAGE|PUPPET");
    warp->add_option("-o,--output", request->output, "The warped picture; - is standard output")
        ->required()
        ->type_name("OUT");
    add_method_options(*warp, *request);
    add_picture_options(*warp, *request);
    request->gates.add_to(*warp);
    add_data_options(*warp, *request);
    warp->add_flag("--strict", request->strict, "Exit 2 when the format cannot hold what there is");
    warp->add_flag("--force", request->force, "Let the output replace the input");
    request->report.add_to(*warp);
    warp->callback([request, warp, &global, &exit_code] {
        if (request->displacement_in.empty()) {
            exit_code = warp_picture(*request, global);
        } else {
            require_map_alone(*warp);
            exit_code = warp_through_map(*request, global);
        }
    });
}

}  // namespace puppetwarp::cli
