#include "command.h"
#include "man_page.h"
#include "option_table.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/output_file.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

namespace puppetwarp::cli {

namespace fs = std::filesystem;

namespace {

struct ManRequest {
    std::optional<std::string> subcommand;
    std::optional<fs::path> folder;
};

const CommandRow& find_command(const OptionTable& table, const std::optional<std::string>& name) {
    if (!name) return table.program;
    for (const CommandRow& each : table.subcommands) {
        if (each.name == *name) return each;
    }
    throw InvalidInput("man '" + *name + "'", "there is no such subcommand", "see puppetwarp --help");
}

void write_all_pages(const OptionTable& table, const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);  // what goes wrong here shows when the pages are written
    write_file(folder / (man_page_name(table.program, table) + ".1"), man_page(table.program, table));
    for (const CommandRow& each : table.subcommands) {
        write_file(folder / (man_page_name(each, table) + ".1"), man_page(each, table));
    }
}

void print_or_write(const ManRequest& request, CLI::App& app) {
    const OptionTable table = option_table(app);
    if (!request.folder) {
        std::cout << man_page(find_command(table, request.subcommand), table);
        return;
    }
    if (request.subcommand) throw InvalidInput("usage", "--all writes every page", "leave the subcommand away");
    write_all_pages(table, *request.folder);
}

}  // namespace

void add_man_command(CLI::App& app, const GlobalOptions& /*global*/, int& /*exit_code*/) {
    CLI::App* man = add_subcommand(app, "man", "Print the manual page of this command or of a subcommand",
                                   "puppetwarp man warp | man -l -\n"
                                   "  puppetwarp man --all ~/.local/share/man/man1");
    const auto request = std::make_shared<ManRequest>();
    std::vector<std::string> names;
    for (const CLI::App* each : app.get_subcommands({})) names.push_back(each->get_name());
    man->add_option("subcommand", request->subcommand, "Whose page (default: that of puppetwarp itself)")
        ->type_name("SUBCOMMAND")
        ->check(completed_by(names));
    man->add_option("--all", request->folder, "Write the pages of all subcommands into a folder")->type_name("FOLDER");
    man->callback([request, &app] { print_or_write(*request, app); });
}

}  // namespace puppetwarp::cli
