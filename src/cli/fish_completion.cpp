#include "completion.h"

namespace puppetwarp::cli {

namespace {

std::string quoted(const std::string& text) {
    std::string result = "'";
    for (const char c : text) {
        if (c == '\'' || c == '\\') result += '\\';
        result += c;
    }
    return result + "'";
}

std::string choices_of(const OptionRow& option) {
    const std::string choices = CLI::detail::join(option.choices, " ");
    return quoted(option.list ? "(__fish_append , " + choices + ")" : choices);
}

// One `complete` command for each option. \param when  the condition under which it is offered, or empty.
std::string completions_of(const CommandRow& command, const std::string& when) {
    const std::string start = "complete -c puppetwarp" + (when.empty() ? "" : " -n " + quoted(when));
    std::string text;
    for (const OptionRow& option : command.options) {
        text += start;
        for (const std::string& name : option.names) {
            text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
        }
        if (option.file) {
            text += " -r -F";
        } else if (!option.value.empty()) {
            text += " -x" + (option.choices.empty() ? "" : " -a " + choices_of(option));
        }
        text += " -d " + quoted(brief(option.description)) + "\n";
    }
    if (command.positionals.empty() && !when.empty()) text += start + " -f\n";
    for (const OptionRow& positional : command.positionals) {
        if (!positional.choices.empty()) text += start + " -f -a " + choices_of(positional) + "\n";
    }
    return text;
}

}  // namespace

std::string fish_completion(const OptionTable& table) {
    std::string text =
        "# fish completion of puppetwarp " PUPPETWARP_VERSION ", made by `puppetwarp completion fish`\n\n";
    text += completions_of(table.program, "");
    for (const CommandRow& each : table.subcommands) {
        text += "\ncomplete -c puppetwarp -n __fish_use_subcommand -f -a " + each.name + " -d " +
                quoted(brief(each.description)) + "\n";
        text += completions_of(each, "__fish_seen_subcommand_from " + each.name);
    }
    return text;
}

}  // namespace puppetwarp::cli
