#include "command.h"
#include "diff_options.h"
#include "diff_report.h"
#include "options.h"
#include "terminal.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/output_file.h>
#include <puppetwarp/base/stage_timer.h>
#include <puppetwarp/diff/compare_files.h>
#include <puppetwarp/diff/compare_folders.h>
#include <puppetwarp/diff/folder_outputs.h>
#include <puppetwarp/diff/html_report.h>
#include <puppetwarp/diff/printable.h>
#include <puppetwarp/diff/side_by_side.h>
#include <puppetwarp/diff/summary.h>
#include <puppetwarp/image/write.h>

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace puppetwarp::cli {

namespace fs = std::filesystem;

namespace {

struct DiffRequest {
    std::string expected;
    std::string actual;
    DiffOptions rules;
    std::string heatmap;
    std::string side_by_side;
    std::string html;
    ReportOptions report;

    bool wants_heat_maps() const { return !heatmap.empty() || !side_by_side.empty() || !html.empty(); }
    bool fills_stdout() const {
        return report.json || report.file == "-" || heatmap == "-" || side_by_side == "-" || html == "-";
    }
};

void write_page(const HtmlReport& page, const std::string& file) {
    OutputFile output(file);
    page.write(output);
    output.commit();
}

// Complains before any work.
void require_outputs(const DiffRequest& request, bool folders) {
    if (!folders) {
        for (const std::string& picture : {request.heatmap, request.side_by_side}) {
            if (!picture.empty()) output_format(picture);
        }
    }
    std::vector<fs::path> outputs{request.html, request.report.file};
    if (!folders) outputs.insert(outputs.end(), {request.heatmap, request.side_by_side});
    require_good_outputs({{request.expected, request.actual, request.rules.mask}, outputs, request.report.json},
                         std::nullopt);
}

void write_pictures(const ComparedFiles& files, const DiffRequest& request, const GlobalOptions& global) {
    if (!request.heatmap.empty()) {
        if (files.comparison.comparable) {
            write_image(files.heat_map, request.heatmap);
        } else if (!global.quiet) {
            print_warning(request.heatmap + ": is not written: " + files.comparison.reason);
        }
    }
    if (!request.side_by_side.empty()) write_image(side_by_side(files), request.side_by_side);
    if (request.html.empty()) return;
    HtmlReport page(request.expected, request.actual);
    page.add({fs::path(request.actual).filename().string(),
              files.comparison.same ? PairState::same : PairState::different,
              files.comparison,
              {}},
             HtmlReport::pictures_of(files));
    write_page(page, request.html);
}

int compare_pictures(const DiffRequest& request, const GlobalOptions& global) {
    require_outputs(request, false);
    const CompareOptions options = request.rules.compare_options();
    ComparedFiles files =
        compare_files(request.expected, request.actual, options, request.rules.reading(), request.wants_heat_maps());
    StageTimer timer(files.timings_ms);
    write_pictures(files, request, global);
    request.report.emit(report_json(files.comparison));
    timer.end("write");
    if (!request.fills_stdout() && !global.quiet) std::cout << summary(files.comparison);
    if (global.verbose) print_timings(files.timings_ms);
    return files.comparison.same ? done : answer_is_no;
}

// Whether a path lies in a folder, or is it.
bool lies_in(const fs::path& path, const fs::path& folder) {
    std::error_code error;
    const fs::path inner = fs::weakly_canonical(fs::absolute(path), error), outer = fs::canonical(folder, error);
    return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

// Pictures that are written into a folder while it is compared would be extra ones.
void require_folder_apart(const std::string& output, const DiffRequest& request) {
    if (output.empty()) return;
    if (output == "-" || (fs::exists(output) && !fs::is_directory(output))) {
        throw InvalidInput(output, "is not a folder", "name one for the pictures of the pairs that differ");
    }
    for (const std::string& input : {request.expected, request.actual}) {
        if (lies_in(output, input)) throw InvalidInput(output, "lies in " + input, "choose a folder outside of it");
    }
}

int finish_folders(const FolderComparison& comparison, const DiffRequest& request, const GlobalOptions& global) {
    if (!request.fills_stdout() && !global.quiet) print_folders(comparison);
    for (const std::string& loop : comparison.loops) {
        if (!global.quiet) print_warning(printable(loop) + ": leads to a folder that it lies in, and is not followed");
    }
    for (const PairResult& pair : comparison.pairs) {
        if (pair.state == PairState::not_compared) print_error(pair.error);
    }
    if (comparison.count(PairState::not_compared) > 0) return user_error;
    return comparison.same ? done : answer_is_no;
}

int compare_trees(const DiffRequest& request, const GlobalOptions& global) {
    require_outputs(request, true);
    require_folder_apart(request.heatmap, request);
    require_folder_apart(request.side_by_side, request);
    const CompareOptions options = request.rules.compare_options();
    FolderOutputs outputs({request.heatmap, request.side_by_side}, !request.html.empty());
    ProgressBar progress(global.quiet);
    std::vector<std::pair<std::string, double>> timings_ms;
    StageTimer timer(timings_ms);
    const FolderComparison comparison =
        compare_folders(request.expected, request.actual, options, request.rules.reading(), request.wants_heat_maps(),
                        outputs, progress);
    timer.end("compare");
    if (!request.html.empty()) {
        write_page(outputs.page(request.expected, request.actual, comparison), request.html);
    }
    request.report.emit(report_json(comparison));
    timer.end("write");
    if (global.verbose) print_timings(timings_ms);
    return finish_folders(comparison, request, global);
}

int compare(const DiffRequest& request, const GlobalOptions& global) {
    std::error_code error;
    const bool expected = fs::is_directory(request.expected, error), actual = fs::is_directory(request.actual, error);
    if (expected && actual) return compare_trees(request, global);
    for (const auto& [folder, file] : {std::pair{expected, request.actual}, std::pair{actual, request.expected}}) {
        if (!folder) continue;
        if (!fs::exists(file, error)) throw InvalidInput(file, "no such folder", "check the path");
        throw InvalidInput(file, "is a file, and the other a folder", "compare two pictures or two folders");
    }
    return compare_pictures(request, global);
}

}  // namespace

void add_diff_command(CLI::App& app, const GlobalOptions& global, int& exit_code) {
    CLI::App* diff = add_subcommand(
        app, "diff", "Compare two pictures, or two folders of them: exit 0 same, 1 different, 2 cannot compare",
        "puppetwarp diff expected.png actual.png --threshold 2/255 --heatmap where.png\n"
        "  puppetwarp diff expected/ actual/ --threshold 4/255 --fail-percent 0.1 --aa --html report.html");
    const auto request = std::make_shared<DiffRequest>();
    diff->add_option("expected", request->expected, "The picture as it should be, or a folder")
        ->required()
        ->type_name("EXPECTED");
    diff->add_option("actual", request->actual, "The picture as it is, or a folder: pictures of the same path compare")
        ->required()
        ->type_name("ACTUAL");
    request->rules.add_to(*diff);
    diff->add_option("--heatmap", request->heatmap,
                     "Write a picture of where they differ; of folders, into this folder for each pair that differs")
        ->type_name("OUT")
        ->check(not_empty());
    diff->add_option("--side-by-side", request->side_by_side,
                     "Write expected, actual and heat map as one picture; of folders, likewise")
        ->type_name("OUT")
        ->check(not_empty());
    diff->add_option("--html", request->html,
                     "Write a page that shows it all, in one file: a table, a slider, a flicker, the heat maps")
        ->type_name("REPORT")
        ->check(not_empty());
    request->report.add_to(*diff);
    diff->callback([request, &global, &exit_code] { exit_code = compare(*request, global); });
}

}  // namespace puppetwarp::cli
