#include "command.h"
#include "option_table.h"
#include "options.h"
#include "report.h"
#include "terminal.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/output_file.h>
#include <puppetwarp/base/stage_timer.h>
#include <puppetwarp/mesh/mesh_file.h>
#include <puppetwarp/project/stiffness_pictures.h>
#include <puppetwarp/rig/add_cage.h>
#include <puppetwarp/rig/snap.h>

#include <cstdio>
#include <memory>
#include <optional>

namespace puppetwarp::cli {

namespace {

struct DeformRequest {
    std::string mesh;
    std::string rig;
    std::optional<std::string> pose;
    std::optional<std::string> method;
    std::optional<std::string> arap_energy;
    std::optional<int> max_iterations;
    std::optional<double> tolerance;
    WeightChoice weights;
    HandleChoice handles;
    double pin_snap_px = 0;
    std::string output;
    GateOptions gates;
    bool force = false;
    ReportOptions report;
};

MethodOptions method_options(const DeformRequest& request, MethodOptions options) {
    if (request.method) options.method = method_from_name(*request.method);
    if (request.arap_energy) options.arap_energy = arap_energy_from_name(*request.arap_energy);
    if (request.max_iterations) options.max_iterations = *request.max_iterations;
    if (request.tolerance) options.tolerance = *request.tolerance;
    options.weights = request.weights.options(options.weights);
    return options;
}

std::string csv_of(const Eigen::MatrixX2d& V) {
    std::string text = "x,y\n";
    char line[80];
    for (Eigen::Index i = 0; i < V.rows(); ++i) {
        std::snprintf(line, sizeof line, "%.17g,%.17g\n", V(i, 0), V(i, 1));
        text += line;
    }
    return text;
}

void require_known_extension(const std::string& output) {
    const std::string extension = std::filesystem::path(output).extension().string();
    if (output != "-" && extension != ".off" && extension != ".obj" && extension != ".csv") {
        throw InvalidInput(output, "the extension says no format of positions", "use .off, .obj or .csv");
    }
}

void write_positions(const TriangleMesh& mesh, const Eigen::MatrixX2d& moved, const std::string& output) {
    if (output == "-" || std::filesystem::path(output).extension() == ".csv") {
        write_file(output, csv_of(moved));
    } else {
        write_mesh({moved, mesh.F}, output);
    }
}

int deform_mesh(const DeformRequest& request, const GlobalOptions& global) {
    require_known_extension(request.output);
    RenderReport report;
    StageTimer timer(report.timings_ms);
    const Puppet puppet = read_puppet(request.rig);
    std::vector<std::filesystem::path> inputs = input_files(request.rig, puppet);
    inputs.emplace_back(request.mesh);
    require_good_outputs(
        {inputs, {request.output, request.report.file, request.handles.save_puppet}, request.report.json},
        request.force);
    const TriangleMesh mesh = read_mesh(request.mesh);
    Rig rig = load_rig_for_mesh(puppet);
    if (request.pin_snap_px > 0) rig = snapped(rig, mesh, request.pin_snap_px);
    if (request.handles.automatic_cage > 0) add_automatic_cage(rig, mesh, request.handles.automatic_cage);
    if (rig.handles.empty()) throw InvalidInput(request.rig, "has no handles", "add at least one");
    const Pose pose = request.pose ? find_pose(puppet, *request.pose) : default_pose(puppet);
    timer.end("read");
    const MethodOptions options = method_options(request, puppet.method);
    ProgressBar progress(global.quiet);
    const std::unique_ptr<Deformer> deformer =
        bound_deformer(options, mesh, rig, request.weights.cache_beside(request.rig), progress);
    timer.end("bind");
    Deformation deformation = deformer->deform(pose, nullptr, progress);
    timer.end("deform");
    describe(options, mesh, rig, pose, deformation, report);
    write_positions(mesh, deformation.V, request.output);
    request.handles.save(puppet, rig);
    timer.end("write");

    if (!global.quiet) print_warnings(report);
    request.report.emit(report_json(report, false));
    if (global.verbose) print_timings(report.timings_ms);
    return request.gates.hold(report.distortion) ? done : answer_is_no;
}

}  // namespace

void add_deform_command(CLI::App& app, const GlobalOptions& global, int& exit_code) {
    CLI::App* deform = add_subcommand(app, "deform", "Move the vertices of a mesh through the handles of a puppet file",
                                      "puppetwarp deform mesh.off --rig rig.puppet.json --method arap -o moved.csv");
    const auto request = std::make_shared<DeformRequest>();
    deform->add_option("mesh", request->mesh, "Triangles (.off, .obj)")->required()->type_name("MESH");
    deform->add_option("--rig", request->rig, "A puppet file with handles and poses")->required()->type_name("PUPPET");
    deform
        ->add_option("-o,--output", request->output, "Moved positions (.off, .obj, .csv); - is CSV to standard output")
        ->required()
        ->type_name("OUT");
    deform->add_option("--pose", request->pose, "A pose of the puppet file (default: its first); rest: the rest pose")
        ->type_name("NAME");
    deform->add_option("--method", request->method, method_list() + " (default: the puppet file's, else arap)")
        ->type_name("M")
        ->check(completed_by(method_names()));
    deform->add_option("--arap-energy", request->arap_energy, "elements (default), spokes, spokes-and-rims")
        ->type_name("E")
        ->check(completed_by(arap_energy_names()));
    deform->add_option("--max-iterations", request->max_iterations, "Of iterative methods, at least 1")
        ->type_name("N")
        ->check(above_zero());
    deform->add_option("--tolerance", request->tolerance, "Relative change of energy to stop at (default 1e-8)")
        ->type_name("T")
        ->check(above_zero());
    request->weights.add_to(*deform, "--weights");
    request->handles.add_to(*deform);
    deform->add_option("--pin-snap", request->pin_snap_px, "Move pins at most PX pixels outside the subject onto it")
        ->type_name("PX")
        ->check(not_negative());
    request->gates.add_to(*deform);
    deform->add_flag("--force", request->force, "Let the output replace the input");
    request->report.add_to(*deform);
    deform->callback([request, &global, &exit_code] { exit_code = deform_mesh(*request, global); });
}

}  // namespace puppetwarp::cli
