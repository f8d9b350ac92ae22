#include "command.h"
#include "options.h"
#include "report.h"

#include <puppetwarp/diff/compare.h>
#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>

#include <cstdio>
#include <future>
#include <iostream>
#include <memory>

namespace puppetwarp::cli {

namespace {

struct DiffRequest {
    std::string expected;
    std::string actual;
    std::string threshold = "0";
    std::string heatmap;
    std::int64_t max_pixels = ReadOptions().max_pixels;
    ReportOptions report;
};

int compare_pictures(const DiffRequest& request, const GlobalOptions& global) {
    const CompareOptions options{parse_threshold(request.threshold)};
    if (!request.heatmap.empty()) output_format(request.heatmap);  // complains before any work
    require_good_outputs(
        {{request.expected, request.actual}, {request.heatmap, request.report.file}, request.report.json}, false);
    // Reading takes far longer than comparing: both at once. Errors name the expected picture first.
    const ReadOptions read{request.max_pixels};
    std::future<Image> reading = std::async(std::launch::async, [&] { return read_image(request.actual, read); });
    const Image expected = read_image(request.expected, read);
    const Image actual = reading.get();

    const Comparison comparison = compare(expected, actual, options);
    if (!request.heatmap.empty() && comparison.comparable) {
        write_image(heat_map(expected, actual, options), request.heatmap);
    }
    request.report.emit(report_json(comparison));
    if (!request.report.json && request.report.file != "-" && !global.quiet && request.heatmap != "-") {
        std::cout << (comparison.same ? "same" : "different: " + comparison.reason) << '\n';
    }
    return comparison.same ? done : answer_is_no;
}

}  // namespace

void add_diff_command(CLI::App& app, const GlobalOptions& global, int& exit_code) {
    CLI::App* diff = add_subcommand(app, "diff", "Compare two pictures: exit 0 same, 1 different, 2 cannot compare",
                                    "puppetwarp diff expected.png actual.png --threshold 2/255 --heatmap where.png");
    const auto request = std::make_shared<DiffRequest>();
    diff->add_option("expected", request->expected, "The picture as it should be")->required()->type_name("EXPECTED");
    diff->add_option("actual", request->actual, "The picture as it is")->required()->type_name("ACTUAL");
    diff->add_option("--threshold", request->threshold,
                     "Differences up to T of full scale are none: 0 to 1, or as 4/255 (default 0)")
        ->type_name("T");
    diff->add_option("--heatmap", request->heatmap, "Write a picture of where they differ")->type_name("OUT");
    diff->add_option("--max-pixels", request->max_pixels, "Refuse larger pictures (default 200000000)")
        ->type_name("N")
        ->check(above_zero());
    request->report.add_to(*diff);
    diff->callback([request, &global, &exit_code] { exit_code = compare_pictures(*request, global); });
}

}  // namespace puppetwarp::cli
