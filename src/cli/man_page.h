#pragma once

#include "option_table.h"

#include <string>

namespace puppetwarp::cli {

//! `puppetwarp` or `puppetwarp-SUBCOMMAND`: what the page of a command is called.
std::string man_page_name(const CommandRow& command, const OptionTable& table);

//! A manual page in section 1, in man(7)'s markup. \param command  the program or a subcommand, of the table.
std::string man_page(const CommandRow& command, const OptionTable& table);

}  // namespace puppetwarp::cli
