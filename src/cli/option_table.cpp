#include "option_table.h"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace puppetwarp::cli {

namespace {

// CLI11 gives validators a name and nothing else to carry; the choices travel in it, one a line after one of these.
constexpr std::string_view one_of_names = "one of\n";
constexpr std::string_view list_of_names = "list of\n";

CLI::Validator carrying(std::string_view kind, const std::vector<std::string>& names) {
    return {[](std::string&) { return std::string(); }, "", std::string(kind) + CLI::detail::join(names, "\n")};
}

std::vector<std::string> split(const std::string& text, char separator) {
    return text.empty() ? std::vector<std::string>() : CLI::detail::split(text, separator);
}

std::vector<const CLI::Validator*> validators_of(CLI::Option& option) {
    std::vector<const CLI::Validator*> found;
    try {
        while (true) found.push_back(option.get_validator(static_cast<int>(found.size())));
    } catch (const CLI::OptionNotFound&) {
        return found;  // the only way to learn how many there are
    }
}

void find_choices(CLI::Option& option, OptionRow& row) {
    for (const CLI::Validator* validator : validators_of(option)) {
        const std::string description = validator->get_description();
        const std::string& carried = validator->get_name();
        if (carried.starts_with(one_of_names) || carried.starts_with(list_of_names)) {
            row.list = carried.starts_with(list_of_names);
            row.choices = split(carried.substr(carried.find('\n') + 1), '\n');
        } else if (description.starts_with('{') && description.ends_with('}')) {  // of CLI::IsMember
            row.list = option.get_delimiter() == ',';
            row.choices = split(description.substr(1, description.size() - 2), ',');
        }
    }
}

// The value's name, without what CLI11 adds to it of the validators.
std::string value_name(const CLI::Option& option) {
    if (option.get_items_expected_max() == 0) return "";
    const std::string type = option.get_type_name();
    return type.substr(0, std::min(type.find(":{"), type.find(":INT in")));
}

// Numbers and coordinates have names of one or two letters or with commas; NAME and COLOUR are words of the puppet's.
bool is_file(const OptionRow& row) {
    return row.choices.empty() && row.value.size() > 2 && row.value.find(',') == std::string::npos &&
           row.value != "NAME" && row.value != "KIND" && row.value.find("INT") == std::string::npos;
}

OptionRow row_of(CLI::Option& option) {
    OptionRow row;
    for (const std::string& name : option.get_snames()) row.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) row.names.push_back("--" + name);
    row.value = value_name(option);
    row.description = option.get_description();
    row.required = option.get_required();
    row.repeated = option.get_expected_max() > 1;
    if (row.repeated && row.value.ends_with("...")) row.value.resize(row.value.size() - 3);
    find_choices(option, row);
    row.file = is_file(row);
    return row;
}

CommandRow row_of(CLI::App& app) {
    CommandRow row{app.get_name(), app.get_description(), app.get_footer(), {}, {}};
    for (CLI::Option* option : app.get_options([](CLI::Option* each) { return !each->get_group().empty(); })) {
        (option->get_positional() ? row.positionals : row.options).push_back(row_of(*option));
    }
    return row;
}

}  // namespace

OptionTable option_table(CLI::App& app) {
    OptionTable table{row_of(app), {}};
    for (CLI::App* subcommand : app.get_subcommands([](CLI::App* each) { return !each->get_group().empty(); })) {
        table.subcommands.push_back(row_of(*subcommand));
    }
    return table;
}

std::vector<OptionRow> global_options(const OptionTable& table, const CommandRow& subcommand) {
    std::vector<OptionRow> options;
    for (const OptionRow& option : table.program.options) {
        const bool own = std::any_of(subcommand.options.begin(), subcommand.options.end(),
                                     [&](const OptionRow& each) { return each.names == option.names; });
        if (!own) options.push_back(option);
    }
    return options;
}

std::string brief(const std::string& description) {
    constexpr std::size_t most = 78;
    if (description.size() <= most) return description;
    return description.substr(0, description.rfind(' ', most - 4)) + " ...";
}

CLI::Validator completed_by(const std::vector<std::string>& names) {
    return carrying(one_of_names, names);
}

CLI::Validator completed_by_list_of(const std::vector<std::string>& names) {
    return carrying(list_of_names, names);
}

}  // namespace puppetwarp::cli
