#pragma once

#include <puppetwarp/diff/options.h>
#include <puppetwarp/image/read.h>

#include <CLI/CLI.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace puppetwarp::cli {

//! What `diff` was asked to let pass, as typed.
struct DiffOptions {
    std::optional<std::string> threshold;
    std::optional<std::string> metric;
    std::optional<std::int64_t> fail_pixels;
    std::optional<double> fail_percent;
    std::optional<std::string> hard_fail;
    std::optional<std::string> min_ssim;
    bool antialiasing = false;
    int window_px = 0;
    std::optional<std::string> window_threshold;
    int shift_px = 0;
    std::string mask;
    std::vector<std::string> ignore;
    std::string alpha = "straight";
    std::optional<double> pixels_per_degree;
    bool metadata = false;
    std::int64_t max_pixels = ReadOptions().max_pixels;

    //! Adds all of them.
    void add_to(CLI::App& diff);
    ReadOptions reading() const { return ReadOptions{max_pixels}; }
    //! Reads the mask, too. \throw InvalidInput  numbers outside their range, rules that do not go together, and as
    //! `read_image`.
    CompareOptions compare_options() const;
};

}  // namespace puppetwarp::cli
