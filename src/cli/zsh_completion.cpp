#include "completion.h"

namespace puppetwarp::cli {

namespace {

// A description inside the single quotes of an argument of `_arguments`.
std::string described(const std::string& text) {
    std::string result;
    for (const char c : brief(text)) {
        if (c == '\'') {
            result += "'\\''";
            continue;
        }
        if (c == '[' || c == ']' || c == ':' || c == '\\') result += '\\';
        result += c;
    }
    return result;
}

// What follows a description: the value's name and how to complete it.
std::string value_of(const OptionRow& option) {
    if (option.value.empty()) return "";
    const std::string name = ":" + described(option.value) + ":";
    const std::string choices = CLI::detail::join(option.choices, " ");
    if (option.list) return name + "_values -s , name " + choices;
    if (!choices.empty()) return name + "(" + choices + ")";
    return name + (option.file ? "_files" : "");
}

std::string argument_of(const OptionRow& option) {
    const std::string repeated = option.repeated ? "*" : "";
    if (option.names.empty()) {
        return "'" + (option.repeated ? "*" : std::string(option.required ? "" : ":")) + value_of(option) + "'";
    }
    const std::string tail = "'[" + described(option.description) + "]" + value_of(option) + "'";
    if (option.names.size() == 1) return "'" + repeated + "'" + option.names.front() + tail;
    const std::string others = option.repeated ? "*" : "(" + CLI::detail::join(option.names, " ") + ")";
    return "'" + others + "'{" + CLI::detail::join(option.names, ",") + "}" + tail;
}

std::string arguments_of(const CommandRow& command, const std::string& indent) {
    std::string text;
    for (const OptionRow& option : command.options) text += " \\\n" + indent + argument_of(option);
    for (const OptionRow& option : command.positionals) text += " \\\n" + indent + argument_of(option);
    return text;
}

}  // namespace

std::string zsh_completion(const OptionTable& table) {
    std::string text = "#compdef puppetwarp\n# zsh completion of puppetwarp " PUPPETWARP_VERSION
                       ", made by `puppetwarp completion zsh`\n\n"
                       "_puppetwarp() {\n    local curcontext=\"$curcontext\" state line\n    local -a subcommands\n"
                       "    typeset -A opt_args\n    _arguments -C";
    text += arguments_of(table.program, "        ");
    text += " \\\n        '1:subcommand:->subcommand' \\\n        '*::argument:->argument'\n";
    text += "    case $state in\n        subcommand)\n            subcommands=(\n";
    for (const CommandRow& each : table.subcommands) {
        text += "                '" + each.name + ":" + described(each.description) + "'\n";
    }
    text += "            )\n            _describe subcommand subcommands ;;\n        argument)\n";
    text += "            curcontext=\"${curcontext%:*}-$line[1]:\"\n            case $line[1] in\n";
    for (const CommandRow& each : table.subcommands) {
        const std::string indent(20, ' ');
        text += "                " + each.name + ")\n" + indent + "_arguments" + arguments_of(each, indent + "    ") +
                arguments_of({"", "", "", {}, global_options(table, each)}, indent + "    ") + " ;;\n";
    }
    return text + "            esac ;;\n    esac\n}\n\n_puppetwarp \"$@\"\n";
}

}  // namespace puppetwarp::cli
