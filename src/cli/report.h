#pragma once

#include <puppetwarp/project/pipeline.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace puppetwarp::cli {

using Json = nlohmann::ordered_json;

//! A number; null for what JSON has no number for: infinity and NaN.
Json finite(double value);

//! Where a report goes.
struct ReportOptions {
    bool json = false;           //!< to standard output
    std::filesystem::path file;  //!< or empty

    //! Adds `--json` and `--report FILE`.
    void add_to(CLI::App& subcommand);
    //! Prints and writes what was asked for. \throw InvalidInput, MachineFault
    void emit(const Json& report) const;
};

//! What a deformation must not do, when that was asked for.
struct GateOptions {
    bool fold = false;
    std::optional<double> stretch;  //!< at least 1

    //! Adds `--fail-on-fold` and `--fail-on-stretch X`.
    void add_to(CLI::App& subcommand);
    //! Whether all that was asked for is so.
    bool hold(const Distortion& distortion) const;
};

//! The report of `warp` and `deform`. What only a picture has (`canvas`, `scale`, `lost`) appears when there is
//! one; of a picture through a displacement map what only a deformation has is null.
Json report_json(const RenderReport& report, bool with_canvas);

//! What the report warns of, a line each on standard error.
void print_warnings(const RenderReport& report);

//! Stages with their times, for `--verbose`, on standard error.
void print_timings(const std::vector<std::pair<std::string, double>>& timings_ms);

}  // namespace puppetwarp::cli
