#pragma once

#include <CLI/CLI.hpp>

namespace puppetwarp::cli {

//! What every subcommand understands.
struct GlobalOptions {
    int threads = 0;  //!< 0: all cores
    bool quiet = false;
    bool verbose = false;
};

//! How a command ended, when it ended without an error.
enum ExitCode : int {
    done = 0,
    answer_is_no = 1,   //!< pictures differ, a gate did not hold
    user_error = 2,     //!< the input or the usage is at fault
    machine_fault = 3,  //!< the program or the machine is at fault
};

// Each subcommand adds itself, its options and an example to `app`; its work runs when the command line has been read
// and leaves what it comes to in `exit_code`.
void add_warp_command(CLI::App& app, const GlobalOptions& global, int& exit_code);
void add_mesh_command(CLI::App& app, const GlobalOptions& global, int& exit_code);
void add_deform_command(CLI::App& app, const GlobalOptions& global, int& exit_code);
void add_weights_command(CLI::App& app, const GlobalOptions& global, int& exit_code);
void add_diff_command(CLI::App& app, const GlobalOptions& global, int& exit_code);
void add_compare_command(CLI::App& app, const GlobalOptions& global, int& exit_code);
void add_info_command(CLI::App& app, const GlobalOptions& global, int& exit_code);
void add_schema_command(CLI::App& app, const GlobalOptions& global, int& exit_code);
void add_completion_command(CLI::App& app, const GlobalOptions& global, int& exit_code);
void add_man_command(CLI::App& app, const GlobalOptions& global, int& exit_code);

//! Adds a subcommand with its example under the options of `--help`.
CLI::App* add_subcommand(CLI::App& app, const std::string& name, const std::string& description,
                         const std::string& example);

//! Reads the command line and runs it. Never throws; the result is the exit code of the process.
int run(int argc, const char* const* argv);

}  // namespace puppetwarp::cli
