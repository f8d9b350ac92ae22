#pragma once

#include "option_table.h"

#include <string>

namespace puppetwarp::cli {

// Scripts that complete subcommands, options, known names of values and file names in a shell.

//! To be sourced, or installed as `puppetwarp` in bash's folder of completions. Needs bash 4 and nothing else.
std::string bash_completion(const OptionTable& table);
//! To be installed as `_puppetwarp` in a folder of zsh's `fpath`.
std::string zsh_completion(const OptionTable& table);
//! To be sourced, or installed as `puppetwarp.fish` in fish's folder of completions.
std::string fish_completion(const OptionTable& table);

}  // namespace puppetwarp::cli
