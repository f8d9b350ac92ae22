#include "command.h"
#include "diff_options.h"
#include "diff_report.h"
#include "options.h"
#include "terminal.h"

#include <puppetwarp/diff/compare_files.h>
#include <puppetwarp/diff/summary.h>
#include <puppetwarp/image/write.h>

#include <iostream>
#include <memory>

namespace puppetwarp::cli {

namespace {

struct DiffRequest {
    std::string expected;
    std::string actual;
    DiffOptions rules;
    std::string heatmap;
    ReportOptions report;

    bool wants_pictures() const { return !heatmap.empty(); }
    bool fills_stdout() const { return report.json || report.file == "-" || heatmap == "-"; }
};

void write_pictures(const ComparedFiles& files, const DiffRequest& request, const GlobalOptions& global) {
    if (!files.comparison.comparable) {
        if (!global.quiet) print_warning("no heat map: " + files.comparison.reason);
        return;
    }
    write_image(files.heat_map, request.heatmap);
}

int compare_pictures(const DiffRequest& request, const GlobalOptions& global) {
    if (!request.heatmap.empty()) output_format(request.heatmap);  // complains before any work
    require_good_outputs({{request.expected, request.actual, request.rules.mask},
                          {request.heatmap, request.report.file},
                          request.report.json},
                         false);
    const CompareOptions options = request.rules.compare_options();
    const ComparedFiles files =
        compare_files(request.expected, request.actual, options, request.rules.reading(), request.wants_pictures());
    if (request.wants_pictures()) write_pictures(files, request, global);
    request.report.emit(report_json(files.comparison));
    if (!request.fills_stdout() && !global.quiet) std::cout << summary(files.comparison);
    return files.comparison.same ? done : answer_is_no;
}

}  // namespace

void add_diff_command(CLI::App& app, const GlobalOptions& global, int& exit_code) {
    CLI::App* diff = add_subcommand(app, "diff", "Compare two pictures: exit 0 same, 1 different, 2 cannot compare",
                                    "puppetwarp diff expected.png actual.png --threshold 2/255 --heatmap where.png");
    const auto request = std::make_shared<DiffRequest>();
    diff->add_option("expected", request->expected, "The picture as it should be")->required()->type_name("EXPECTED");
    diff->add_option("actual", request->actual, "The picture as it is")->required()->type_name("ACTUAL");
    request->rules.add_to(*diff);
    diff->add_option("--heatmap", request->heatmap, "Write a picture of where they differ")->type_name("OUT");
    request->report.add_to(*diff);
    diff->callback([request, &global, &exit_code] { exit_code = compare_pictures(*request, global); });
}

}  // namespace puppetwarp::cli
