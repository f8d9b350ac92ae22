#include "command.h"
#include "options.h"
#include "report.h"
#include "terminal.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/image/write.h>
#include <puppetwarp/project/overlay.h>
#include <puppetwarp/warp/background.h>

#include <algorithm>
#include <memory>
#include <optional>

namespace puppetwarp::cli {

namespace {

// What `warp` was asked for, as typed.
struct WarpRequest {
    std::string input;
    std::string output;
    std::vector<std::string> pins;
    std::optional<std::string> pose;
    std::optional<std::string> method;
    std::optional<std::string> arap_energy;
    WeightChoice weights;
    std::string canvas = "keep";
    std::string interpolation = "bicubic";
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
    if (report.distortion.flipped_triangles > 0) {
        print_warning(std::to_string(report.distortion.flipped_triangles) + " triangles are folded over and " +
                      (back_faces == BackFaces::hide ? "not drawn" : "drawn mirrored") + " (pull less, or add a pin)");
    }
}

int warp_picture(const WarpRequest& request, const GlobalOptions& global) {
    RenderOptions options;
    options.read.max_pixels = request.max_pixels;
    options.interpolation = interpolation_from_name(request.interpolation);
    options.canvas = parse_canvas(request.canvas);
    options.pin_snap_px = request.pin_snap_px;
    options.weights_cache = request.weights.cache_beside(request.input);
    options.format = output_format(request.output);

    Puppet puppet = open_puppet(request.input);
    Pose pose = request.pose ? find_pose(puppet, *request.pose) : default_pose(puppet);
    apply(request, puppet, pose);
    require_good_outputs(
        {input_files(request.input, puppet), {request.output, request.report.file}, request.report.json},
        request.force);

    ProgressBar progress(global.quiet);
    Rendered rendered = render(puppet, pose, options, progress);
    tell_what_is_lost(request, rendered.report, global.quiet);
    warn_about_result(rendered.report, puppet.back_faces, global.quiet);
    const Canvas& canvas = rendered.report.canvas;
    if (request.wants_overlay("mesh")) draw_mesh(rendered.image, rendered.moved, rendered.mesh.F, canvas);
    if (request.wants_overlay("handles")) draw_handles(rendered.image, rendered.rig, pose, canvas);

    const auto start = std::chrono::steady_clock::now();
    write_image(rendered.image, request.output, {request.compression, request.quality});
    const std::chrono::duration<double, std::milli> writing = std::chrono::steady_clock::now() - start;
    rendered.report.timings_ms.emplace_back("write", writing.count());
    request.report.emit(report_json(rendered.report, true));
    if (global.verbose) print_timings(rendered.report);
    return request.gates.hold(rendered.report.distortion) ? done : answer_is_no;
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
        ->type_name("M");
    warp.add_option("--arap-energy", request.arap_energy, "elements (default), spokes, spokes-and-rims")
        ->type_name("E");
    request.weights.add_to(warp, "--weights");
    warp.add_option("--pin-snap", request.pin_snap_px, "Move pins at most PX pixels outside the subject onto it")
        ->type_name("PX")
        ->check(not_negative());
}

void add_picture_options(CLI::App& warp, WarpRequest& request) {
    warp.add_option("--canvas", request.canvas, "keep (default), grow so that nothing is cut off, or WxH+X+Y")
        ->type_name("C");
    warp.add_option("--interpolation", request.interpolation, "nearest, bilinear, bicubic (default)")->type_name("I");
    warp.add_option("--background", request.background, "transparent (default), keep, inpaint, #rrggbb or #rrggbbaa")
        ->type_name("B");
    warp.add_option("--back-faces", request.back_faces,
                    "Triangles that are folded over: hide (default) or show, mirrored")
        ->type_name("B");
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

}  // namespace

void add_warp_command(CLI::App& app, const GlobalOptions& global, int& exit_code) {
    CLI::App* warp = add_subcommand(app, "warp", "Warp a picture through pins or a puppet file",
                                    "puppetwarp warp photo.jpg --pin 100,200 --pin 320,90:360,40 -o out.jpg\n"
                                    "  puppetwarp warp gingerbread.puppet.json --pose wave -o wave.png");
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
    warp->add_flag("--strict", request->strict, "Exit 2 when the format cannot hold what there is");
    warp->add_flag("--force", request->force, "Let the output replace the input");
    request->report.add_to(*warp);
    warp->callback([request, &global, &exit_code] { exit_code = warp_picture(*request, global); });
}

}  // namespace puppetwarp::cli
