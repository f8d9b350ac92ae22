#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace puppetwarp::cli {

//! An option, a flag or a positional argument, as `--help` shows it.
struct OptionRow {
    std::vector<std::string> names;  //!< `-o`, `--output`; none: a positional argument
    std::string value;               //!< what stands for its value in the help, such as `OUT`; empty: a flag
    std::string description;
    bool required = false;
    bool repeated = false;             //!< may be given several times, or take several values
    std::vector<std::string> choices;  //!< names that its value can have; what they leave out may be possible too
    bool list = false;                 //!< several of the choices, with commas between them
    bool file = false;                 //!< its value is a path
};

//! A subcommand, or the program itself, with everything that its help shows.
struct CommandRow {
    std::string name;
    std::string description;
    std::string footer;  //!< examples and more, as `--help` ends
    std::vector<OptionRow> positionals;
    std::vector<OptionRow> options;
};

//! What man pages and completions are made of: the options that the program parses, no second list of them.
struct OptionTable {
    CommandRow program;  //!< its options go with every subcommand
    std::vector<CommandRow> subcommands;
};

OptionTable option_table(CLI::App& app);

//! The program's options that go with a subcommand beside its own ones.
std::vector<OptionRow> global_options(const OptionTable& table, const CommandRow& subcommand);

//! As much of a description as a line of completions has room for.
std::string brief(const std::string& description);

//! For `Option::check`: names that the value of an option can have, for completions. Any value passes: the option's
//! own reader knows better why it refuses one. (`CLI::IsMember` is found without this.)
CLI::Validator completed_by(const std::vector<std::string>& names);

//! The same where the value is several of them, with commas between them.
CLI::Validator completed_by_list_of(const std::vector<std::string>& names);

}  // namespace puppetwarp::cli
