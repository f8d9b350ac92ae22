#include "report.h"
#include "options.h"
#include "terminal.h"

#include <puppetwarp/base/output_file.h>

#include <cmath>
#include <cstdio>
#include <iostream>
#include <utility>

#include <sys/resource.h>

namespace puppetwarp::cli {

namespace {

double peak_memory_mb() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

}  // namespace

Json finite(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

void ReportOptions::add_to(CLI::App& subcommand) {
    subcommand.add_flag("--json", json, "Print a report to standard output as one JSON object");
    subcommand.add_option("--report", file, "Write the report to a file")->type_name("FILE")->check(not_empty());
}

void ReportOptions::emit(const Json& report) const {
    const std::string text = report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
    if (!file.empty()) write_file(file, text);
    if (json) std::cout << text;
}

Json report_json(const RenderReport& report, bool with_canvas) {
    Json json;
    const bool deformed = !report.method.empty();
    // What nothing was deformed for is null.
    const auto of_deformation = [&](const char* key, Json value) { json[key] = deformed ? std::move(value) : nullptr; };
    of_deformation("method", report.method);
    of_deformation("vertices", report.vertices);
    of_deformation("triangles", report.triangles);
    of_deformation("handles", report.handles);
    of_deformation("iterations", report.iterations);
    of_deformation("converged", report.converged);
    of_deformation("energy", finite(report.energy));
    Json history = Json::array();
    for (const double energy : report.energy_history) history.push_back(finite(energy));
    of_deformation("energy_history", std::move(history));
    of_deformation("flipped_triangles", report.distortion.flipped_triangles);
    of_deformation("max_stretch", finite(report.distortion.max_stretch));
    of_deformation("max_area_ratio", finite(report.distortion.max_area_ratio));
    of_deformation("max_handle_error_px", finite(report.max_handle_error_px));
    json["warnings"] = report.warnings;
    json["canvas"] = nullptr;
    if (with_canvas) {
        const Canvas& canvas = report.canvas;
        json["canvas"] = {{"x", canvas.x}, {"y", canvas.y}, {"width", canvas.width}, {"height", canvas.height}};
        json["scale"] = report.scale;
        of_deformation("max_magnification", finite(report.max_magnification));
        json["lost"] = report.lost;
    }
    json["timings_ms"] = Json::object();
    for (const auto& [stage, ms] : report.timings_ms) json["timings_ms"][stage] = std::round(ms * 1000) / 1000;
    json["peak_memory_mb"] = std::round(peak_memory_mb() * 10) / 10;
    return json;
}

void print_warnings(const RenderReport& report) {
    for (const std::string& warning : report.warnings) print_warning(warning);
    if (!report.converged) {
        print_warning(report.method + " did not converge in " + std::to_string(report.iterations) + " iterations");
    }
}

void GateOptions::add_to(CLI::App& subcommand) {
    subcommand.add_flag("--fail-on-fold", fold, "Exit 1 when a triangle is folded over");
    subcommand
        .add_option("--fail-on-stretch", stretch, "Exit 1 when a triangle is stretched more than X times, X at least 1")
        ->type_name("X")
        ->check([](const std::string& text) -> std::string {
            return parse_number(text, "--fail-on-stretch") >= 1 ? "" : "it must be at least 1";
        });
}

bool GateOptions::hold(const Distortion& distortion) const {
    if (fold && distortion.flipped_triangles > 0) return false;
    return !stretch || distortion.max_stretch <= *stretch;
}

void print_timings(const std::vector<std::pair<std::string, double>>& timings_ms) {
    for (const auto& [stage, ms] : timings_ms) std::fprintf(stderr, "%-12s %9.2f ms\n", stage.c_str(), ms);
}

}  // namespace puppetwarp::cli
