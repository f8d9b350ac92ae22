#pragma once

#include <puppetwarp/base/point.h>
#include <puppetwarp/project/pipeline.h>
#include <puppetwarp/project/puppet.h>

#include <CLI/CLI.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace puppetwarp::cli {

//! A finite number, all of the text. \throw InvalidInput  named after `option`.
double parse_number(const std::string& text, const std::string& option);

//! One `--pin X,Y[:X2,Y2][@DEG]`.
struct Pin {
    Point at;
    std::optional<Point> to;
    std::optional<double> rotate_rad;
};
//! \throw InvalidInput  anything else, numbers that are not finite.
Pin parse_pin(const std::string& text);

//! `keep`, `grow` or `WxH+X+Y` (either sign before X and Y; no X and Y: at the origin). \throw InvalidInput
CanvasChoice parse_canvas(const std::string& text);

//! A share: `0.02` or `4/255`. \throw InvalidInput  outside 0 to 1, named after `option`.
double parse_share(const std::string& text, const std::string& option);

//! Checks of options, with errors a person can read.
CLI::Validator above_zero();
CLI::Validator not_negative();
CLI::Validator not_empty();

//! Which weights a command was asked for.
struct WeightChoice {
    std::optional<std::string> kind;
    std::optional<std::string> partition;
    std::optional<double> l1_budget;
    bool no_cache = false;

    //! Adds `option KIND`, `--partition`, `--l1-budget` and `--no-cache`. \param option  `--weights` beside a method,
    //! `--kind` alone.
    void add_to(CLI::App& subcommand, const std::string& option);
    //! `usual` with what was asked for. \throw InvalidInput  unknown names.
    WeightOptions options(WeightOptions usual) const;
    //! Where weights are kept beside a puppet file; empty for a picture, and with `--no-cache`.
    std::filesystem::path cache_beside(const std::filesystem::path& input) const;
};

//! Handles that a command makes by itself, and a file to keep them in.
struct HandleChoice {
    int automatic_cage = 0;  //!< corners; 0: no cage
    std::string save_puppet;

    //! Adds `--auto-cage` and `--save-puppet`.
    void add_to(CLI::App& subcommand);
    //! Where asked for, writes a puppet with a rig's handles as it was typed: its own, and the automatic cage, which is
    //! the last of `rig`.
    void save(Puppet puppet, const Rig& rig) const;
};

//! The names of `ArapEnergy`.
std::vector<std::string> arap_energy_names();

//! The names of all methods, for help texts.
std::string method_list();

//! Adds pins to a puppet's rig, and their targets to `pose`.
void add_pins(Puppet& puppet, Pose& pose, const std::vector<std::string>& pins);

//! `.png` of `A.PNG`; empty when there is none.
std::string lower_extension(const std::filesystem::path& path);

//! True when a file is a puppet file: its name ends in `.json`.
bool is_puppet_file(const std::filesystem::path& path);

//! True when a file is a mesh: its name ends in `.off` or `.obj`.
bool is_mesh_file(const std::filesystem::path& path);

//! A puppet from a puppet file, or one around a picture. \throw InvalidInput  as `read_puppet`; missing picture.
Puppet open_puppet(const std::filesystem::path& path);

//! The puppet or picture itself and what the puppet names: its picture and its mask.
std::vector<std::filesystem::path> input_files(const std::filesystem::path& path, const Puppet& puppet);

//! What a command reads and writes, looked at before any work.
struct Files {
    std::vector<std::filesystem::path> inputs;   //!< empty paths are passed over
    std::vector<std::filesystem::path> outputs;  //!< likewise; `-` is standard output
    bool json_to_stdout = false;                 //!< the report goes there too
};

//! \param force  whether outputs may replace inputs; none: the command has no `--force`, and they never may.
//! \throw InvalidInput  an output is an input and `force` is not set; two results want one file or standard output;
//!        an output cannot be written.
void require_good_outputs(const Files& files, std::optional<bool> force);

}  // namespace puppetwarp::cli
