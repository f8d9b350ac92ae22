#include "command.h"
#include "option_table.h"
#include "options.h"
#include "report.h"
#include "terminal.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/image/write.h>
#include <puppetwarp/project/method_sheet.h>

#include <memory>
#include <optional>
#include <set>

namespace puppetwarp::cli {

namespace {

// What `compare-methods` was asked for, as typed.
struct CompareRequest {
    std::string input;
    std::string output;
    std::vector<std::string> pins;
    std::optional<std::string> pose;
    std::optional<std::string> methods;
    std::string show = "picture";
    std::optional<int> columns;
    MethodSheetOptions options;
    bool force = false;
    ReportOptions report;
};

// The names between commas. \throw InvalidInput  one is empty.
std::vector<std::string> names_in(const std::string& list) {
    std::vector<std::string> names;
    for (std::size_t start = 0; start <= list.size();) {
        const std::size_t end = std::min(list.find(',', start), list.size());
        names.push_back(list.substr(start, end - start));
        if (names.back().empty()) {
            throw InvalidInput("--methods '" + list + "'", "has an empty name", "write names with commas between them");
        }
        start = end + 1;
    }
    return names;
}

MethodSheetOptions sheet_options(const CompareRequest& request) {
    MethodSheetOptions options = request.options;
    if (request.methods) options.methods = names_in(*request.methods);
    if (request.show == "distortion") options.show = MethodSheetOptions::Show::distortion;
    if (request.columns) {
        if (*request.columns < 1) throw InvalidInput("--columns", "must be at least 1");
        options.columns = *request.columns;
    }
    return options;
}

// The report of one method: the fields of `deform`, null where it could not take the pose.
Json result_json(const MethodResult& result) {
    Json fields = report_json(result.report, false);
    fields.erase("canvas");
    fields.erase("peak_memory_mb");
    Json json;
    json["label"] = result.label;
    for (const auto& [key, value] : fields.items()) json[key] = result.error.empty() ? value : Json(nullptr);
    json["cut_off"] = result.error.empty() ? Json(result.cut_off) : Json(nullptr);
    json["error"] = result.error.empty() ? Json(nullptr) : Json(result.error);
    return json;
}

Json sheet_json(const MethodSheet& sheet) {
    RenderReport shared;
    shared.canvas = sheet.canvas;
    shared.timings_ms = sheet.timings_ms;
    const Json fields = report_json(shared, true);
    Json json;
    json["pose"] = sheet.pose;
    json["vertices"] = sheet.mesh.V.rows();
    json["triangles"] = sheet.mesh.F.rows();
    json["handles"] = sheet.rig.handles.size();
    json["canvas"] = fields["canvas"];
    json["sheet"] = {{"width", sheet.image.width()},
                     {"height", sheet.image.height()},
                     {"columns", sheet.columns},
                     {"rows", sheet.rows}};
    json["methods"] = Json::array();
    for (const MethodResult& result : sheet.methods) json["methods"].push_back(result_json(result));
    json["timings_ms"] = fields["timings_ms"];
    json["peak_memory_mb"] = fields["peak_memory_mb"];
    return json;
}

void warn_about(const MethodSheet& sheet) {
    std::set<std::string> said;  // most warnings are of the handles, the same for each method
    for (const MethodResult& result : sheet.methods) {
        if (!result.error.empty()) print_warning(result.label + ": " + result.error);
        for (const std::string& warning : result.report.warnings) {
            if (said.insert(warning).second) print_warning(warning);
        }
        if (result.error.empty() && !result.report.converged) {
            print_warning(result.label + " did not converge in " + std::to_string(result.report.iterations) +
                          " iterations");
        }
    }
}

int draw_comparison(const CompareRequest& request, const GlobalOptions& global) {
    output_format(request.output);  // complains before any work
    const MethodSheetOptions options = sheet_options(request);
    Puppet puppet = open_puppet(request.input);
    Pose pose = request.pose ? find_pose(puppet, *request.pose) : default_pose(puppet);
    add_pins(puppet, pose, request.pins);
    require_sound(puppet.rig);
    require_good_outputs(
        {input_files(request.input, puppet), {request.output, request.report.file}, request.report.json},
        request.force);

    ProgressBar progress(global.quiet);
    MethodSheet sheet = compare_methods(puppet, pose, options, progress);
    if (!global.quiet) warn_about(sheet);
    const auto start = std::chrono::steady_clock::now();
    write_image(sheet.image, request.output);
    const std::chrono::duration<double, std::milli> writing = std::chrono::steady_clock::now() - start;
    sheet.timings_ms.emplace_back("write", writing.count());
    request.report.emit(sheet_json(sheet));
    if (global.verbose) print_timings(sheet.timings_ms);
    return done;
}

void add_sheet_options(CLI::App& compare, CompareRequest& request) {
    compare
        .add_option(
            "--methods", request.methods,
            "Names with commas between them, as they stand on the sheet (default: all): " +
                [] {
                    std::string list;
                    for (const LabelledMethod& each : labelled_methods()) {
                        list += (list.empty() ? "" : ", ") + each.label;
                    }
                    return list;
                }())
        ->type_name("M,M,...")
        ->check(completed_by_list_of(method_names()));
    compare
        .add_option("--show", request.show,
                    "picture (default), or distortion: triangles red where they grow, blue where they shrink, grey "
                    "where they shear, magenta where they fold")
        ->type_name("S")
        ->check(CLI::IsMember({"picture", "distortion"}));
    compare.add_option("--columns", request.columns, "Cells in a row (default: so that the sheet is about 3 to 2)")
        ->type_name("N");
    compare.add_option("--cell-px", request.options.cell_px, "Longer side of each picture, 120 to 2000 (default 320)")
        ->type_name("N");
    compare.add_flag("--timings", request.options.timings,
                     "Print times on the sheet too, which then differs from run to run; the report always has them");
}

}  // namespace

void add_compare_command(CLI::App& app, const GlobalOptions& global, int& exit_code) {
    CLI::App* compare = add_subcommand(
        app, "compare-methods", "Draw a sheet of the same pose through every method, with folds, stretch and energy",
        "puppetwarp compare-methods gingerbread.puppet.json --pose wave -o sheet.png\n"
        "  puppetwarp compare-methods cat.png --pin 90,60:70,40 --pin 200,150 --show distortion -o sheet.png");
    const auto request = std::make_shared<CompareRequest>();
    compare->add_option("input", request->input, "A picture, or a puppet file (.json)")
        ->required()
        ->type_name("IMAGE|PUPPET");
    compare->add_option("-o,--output", request->output, "The sheet, a picture; - is standard output")
        ->required()
        ->type_name("SHEET");
    compare->add_option("--pose", request->pose, "A pose of the puppet file (default: its first); rest: the rest pose")
        ->type_name("NAME");
    compare
        ->add_option("--pin", request->pins,
                     "A pin: X,Y holds a place, X,Y:X2,Y2 moves it, @DEG turns it; again for more pins")
        ->type_name("X,Y[:X2,Y2][@DEG]")
        ->allow_extra_args(false);
    compare
        ->add_option("--pin-snap", request->options.pin_snap_px,
                     "Move pins at most PX pixels outside the subject onto it")
        ->type_name("PX")
        ->check(not_negative());
    add_sheet_options(*compare, *request);
    compare->add_flag("--force", request->force, "Let the output replace the input");
    request->report.add_to(*compare);
    compare->callback([request, &global, &exit_code] { exit_code = draw_comparison(*request, global); });
}

}  // namespace puppetwarp::cli
