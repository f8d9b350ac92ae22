#include "command.h"
#include "options.h"
#include "report.h"
#include "terminal.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/output_file.h>
#include <puppetwarp/base/stage_timer.h>
#include <puppetwarp/image/write.h>
#include <puppetwarp/mesh/mesh_file.h>
#include <puppetwarp/project/stiffness_pictures.h>
#include <puppetwarp/project/weight_sheet.h>
#include <puppetwarp/project/weights_cache.h>
#include <puppetwarp/rig/add_cage.h>
#include <puppetwarp/rig/snap.h>
#include <puppetwarp/weights/weight_text.h>

#include <memory>
#include <optional>
#include <utility>

namespace puppetwarp::cli {

namespace {

// What `weights` was asked for, as typed.
struct WeightsRequest {
    std::string input;
    std::optional<std::string> rig;
    std::vector<std::string> pins;
    WeightChoice choice;
    HandleChoice handles;
    std::optional<int> max_iterations;
    std::optional<double> tolerance;
    std::string output;
    double pin_snap_px = 0;
    WeightSheetOptions sheet;
    bool force = false;
    ReportOptions report;
};

enum class OutputFormat { csv, dmat, picture };

OutputFormat format_of(const std::string& output) {
    const std::string extension = std::filesystem::path(output).extension().string();
    if (output == "-" || extension == ".csv") return OutputFormat::csv;
    if (extension == ".dmat") return OutputFormat::dmat;
    try {
        output_format(output);
    } catch (const InvalidInput&) {
        throw InvalidInput(output, "the extension says no format of weights", "use .csv, .dmat or that of a picture");
    }
    return OutputFormat::picture;
}

// What weights are made for.
struct Subject {
    Puppet puppet;
    TriangleMesh mesh;
    Rig rig;
    WeightOptions options;
};

WeightOptions weight_options(const WeightsRequest& request, const WeightOptions& usual) {
    WeightOptions options = request.choice.options(usual);
    if (request.max_iterations) options.max_iterations = *request.max_iterations;
    if (request.tolerance) options.tolerance = *request.tolerance;
    return options;
}

void require_good_outputs(std::vector<std::filesystem::path> inputs, const WeightsRequest& request) {
    const Files files{
        std::move(inputs), {request.output, request.report.file, request.handles.save_puppet}, request.report.json};
    require_good_outputs(files, request.force);
}

Subject subject_of_mesh(const WeightsRequest& request) {
    if (!request.rig && request.handles.automatic_cage == 0) {
        throw InvalidInput(request.input, "a mesh has no handles of its own", "add --rig PUPPET or --auto-cage N");
    }
    Subject subject;
    if (request.rig) subject.puppet = read_puppet(*request.rig);
    Pose pose;
    add_pins(subject.puppet, pose, request.pins);
    require_sound(subject.puppet.rig);
    std::vector<std::filesystem::path> inputs;
    if (request.rig) inputs = input_files(*request.rig, subject.puppet);
    inputs.emplace_back(request.input);
    require_good_outputs(inputs, request);
    subject.mesh = read_mesh(request.input);
    subject.rig = snapped(load_rig_for_mesh(subject.puppet), subject.mesh, request.pin_snap_px);
    if (request.handles.automatic_cage > 0) {
        add_automatic_cage(subject.rig, subject.mesh, request.handles.automatic_cage);
    }
    return subject;
}

Subject subject_of_picture(const WeightsRequest& request) {
    if (request.rig) throw InvalidInput("--rig", "goes with a mesh", "a puppet file has its own handles");
    Subject subject;
    subject.puppet = open_puppet(request.input);
    Pose pose;
    add_pins(subject.puppet, pose, request.pins);
    require_sound(subject.puppet.rig);
    require_good_outputs(input_files(request.input, subject.puppet), request);
    const Image image = load_image(subject.puppet);
    const Cutout cutout = cut_out_subject(subject.puppet, image);
    const Outline outline = outline_subject(subject.puppet, image.width(), image.height(), cutout);
    subject.mesh = mesh_for_weights(subject.puppet, outline);
    const Rig rig = load_rig(subject.puppet, image.width(), image.height());
    subject.rig = snapped(rig, subject.mesh, request.pin_snap_px);
    if (request.handles.automatic_cage > 0) {
        add_automatic_cage(subject.rig, outline, request.handles.automatic_cage);
    }
    return subject;
}

Subject subject_of(const WeightsRequest& request) {
    Subject subject = is_mesh_file(request.input) ? subject_of_mesh(request) : subject_of_picture(request);
    subject.options = weight_options(request, subject.puppet.method.weights);
    subject.puppet.method.weights = subject.options;
    return subject;
}

Json weights_json(const Subject& subject, const Weights& weights, const RenderReport& times) {
    Json json;
    json["kind"] = weight_kind_name(subject.options.kind);
    if (subject.options.kind == WeightKind::bbw) json["partition"] = partition_name(subject.options.partition);
    json["vertices"] = weights.W.rows();
    json["handles"] = subject.rig.handles.size();
    json["columns"] = weights.columns.size();
    json["iterations"] = weights.iterations;
    json["converged"] = weights.converged;
    json["min"] = weights.W.minCoeff();
    json["max"] = weights.W.maxCoeff();
    json["partition_error"] = weights.partition_error;
    json["kkt_residual"] = weights.kkt_residual;
    json["fallback"] = weights.fallback.empty() ? Json(nullptr) : Json(weights.fallback);
    json["warnings"] = weight_warnings(weights);
    json["timings_ms"] = report_json(times, false)["timings_ms"];
    return json;
}

void write_weights(const Subject& subject, const Weights& weights, const WeightsRequest& request, Progress& progress) {
    switch (format_of(request.output)) {
        case OutputFormat::csv: write_file(request.output, weights_csv(subject.rig, weights)); break;
        case OutputFormat::dmat: write_file(request.output, weights_dmat(weights)); break;
        case OutputFormat::picture:
            const std::string title = std::filesystem::path(request.input).filename().string() + ", " +
                                      weight_kind_name(subject.options.kind) + " weights";
            write_image(draw_weight_sheet(subject.mesh, subject.rig, weights, title, request.sheet, progress),
                        request.output);
            break;
    }
}

int make_weights(const WeightsRequest& request, const GlobalOptions& global) {
    format_of(request.output);  // complains before any work
    RenderReport times;
    StageTimer timer(times.timings_ms);
    const Subject subject = subject_of(request);
    timer.end("read");
    ProgressBar progress(global.quiet);
    const Weights weights = cached_weights(subject.mesh, subject.rig, subject.options,
                                           request.choice.cache_beside(request.rig.value_or(request.input)), progress);
    timer.end("weights");
    write_weights(subject, weights, request, progress);
    request.handles.save(subject.puppet, subject.rig);
    timer.end("write");
    times.warnings = weight_warnings(weights);
    if (!global.quiet) print_warnings(times);
    request.report.emit(weights_json(subject, weights, times));
    if (global.verbose) print_timings(times.timings_ms);
    return done;
}

}  // namespace

void add_weights_command(CLI::App& app, const GlobalOptions& global, int& exit_code) {
    CLI::App* weights =
        add_subcommand(app, "weights", "Compute how much each vertex follows each handle, as numbers or as heat maps",
                       "puppetwarp weights gingerbread.puppet.json --kind bbw -o weights.png\n"
                       "  puppetwarp weights mesh.off --rig rig.puppet.json --kind harmonic -o weights.csv");
    const auto request = std::make_shared<WeightsRequest>();
    weights->add_option("input", request->input, "A mesh (.off, .obj), a picture, or a puppet file (.json)")
        ->required()
        ->type_name("MESH|IMAGE|PUPPET");
    weights
        ->add_option("-o,--output", request->output,
                     "Numbers (.csv, .dmat) or a sheet of heat maps, a picture; - is CSV to standard output")
        ->required()
        ->type_name("OUT");
    weights->add_option("--rig", request->rig, "A puppet file with handles, for a mesh")->type_name("PUPPET");
    weights->add_option("--pin", request->pins, "A point handle at X,Y; again for more")
        ->type_name("X,Y")
        ->allow_extra_args(false);
    request->choice.add_to(*weights, "--kind");
    request->handles.add_to(*weights);
    weights
        ->add_option("--max-iterations", request->max_iterations, "Of bbw, l1 and monotonic, at least 1 (default 200)")
        ->type_name("N")
        ->check(above_zero());
    weights
        ->add_option("--tolerance", request->tolerance,
                     "Of bbw, l1 and monotonic: KKT residual to stop at (default 1e-8)")
        ->type_name("T")
        ->check(above_zero());
    weights->add_option("--pin-snap", request->pin_snap_px, "Move pins at most PX pixels outside the subject onto it")
        ->type_name("PX")
        ->check(not_negative());
    weights->add_option("--columns", request->sheet.columns, "Heat maps in a row (default: a sheet of about 3 to 2)")
        ->type_name("N")
        ->check(above_zero());
    weights->add_option("--cell-px", request->sheet.cell_px, "Longer side of each map, 120 to 2000 (default 320)")
        ->type_name("N");
    weights->add_flag("--force", request->force, "Let the output replace the input");
    request->report.add_to(*weights);
    weights->callback([request, &global, &exit_code] { exit_code = make_weights(*request, global); });
}

}  // namespace puppetwarp::cli
