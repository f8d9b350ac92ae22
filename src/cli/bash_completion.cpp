#include "completion.h"

namespace puppetwarp::cli {

namespace {

// What the generated cases call. `current` is the word before the cursor.
constexpr const char* functions = R"bash(
_puppetwarp_choose() {
    local word
    for word in "$@"; do
        if [[ $word == "$current"* ]]; then COMPREPLY+=("$word"); fi
    done
}

_puppetwarp_choose_several() {
    local before="" word
    if [[ $current == *,* ]]; then before=${current%,*},; fi
    for word in "$@"; do
        if [[ ,$before != *",$word,"* ]]; then _puppetwarp_choose "$before$word"; fi
    done
    compopt -o nospace 2>/dev/null
}

_puppetwarp_choose_file() {
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
    compopt -o filenames 2>/dev/null
}

_puppetwarp() {
    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} subcommand="" i
    COMPREPLY=()
    # --option=value is three words here.
    if [[ $current == = ]]; then
        current=""
    elif [[ $previous == = ]]; then
        previous=${COMP_WORDS[COMP_CWORD - 2]}
    fi
)bash";

std::string quoted(const std::string& word) {
    return "'" + CLI::detail::find_and_replace(word, "'", "'\\''") + "'";
}

std::string words(const std::vector<std::string>& list) {
    std::string text;
    for (const std::string& word : list) text += " " + quoted(word);
    return text;
}

std::vector<std::string> names_of(const OptionTable& table) {
    std::vector<std::string> names;
    for (const CommandRow& each : table.subcommands) names.push_back(each.name);
    return names;
}

// The call that completes a value, or nothing where nothing is known of it.
std::string chooser(const OptionRow& option) {
    if (option.list) return "_puppetwarp_choose_several" + words(option.choices);
    if (!option.choices.empty()) return "_puppetwarp_choose" + words(option.choices);
    return option.file ? "_puppetwarp_choose_file" : ":";
}

// Cases of `$subcommand:$previous`, options that are completed alike together.
class ValueCases {
public:
    void add(const CommandRow& command, const std::string& subcommand) {
        for (const OptionRow& option : command.options) {
            if (option.value.empty()) continue;
            std::vector<std::string>& patterns = patterns_of(chooser(option));
            for (const std::string& name : option.names) patterns.emplace_back(subcommand).append(":").append(name);
        }
    }
    std::string text() const {
        std::string result;
        for (const auto& [call, patterns] : cases_) {
            result += "        " + CLI::detail::join(patterns, " | \\\n            ") + ")\n            " + call +
                      "\n            return ;;\n";
        }
        return result;
    }

private:
    std::vector<std::string>& patterns_of(const std::string& call) {
        for (auto& [known, patterns] : cases_) {
            if (known == call) return patterns;
        }
        return cases_.emplace_back(call, std::vector<std::string>()).second;
    }

    std::vector<std::pair<std::string, std::vector<std::string>>> cases_;
};

std::string options_case(const std::string& subcommand, std::vector<OptionRow> options,
                         const std::vector<OptionRow>& more) {
    options.insert(options.end(), more.begin(), more.end());
    std::vector<std::string> names;
    for (const OptionRow& option : options) names.insert(names.end(), option.names.begin(), option.names.end());
    return "            " + subcommand + ") _puppetwarp_choose" + words(names) + " ;;\n";
}

std::string positional_case(const CommandRow& command) {
    if (command.positionals.empty()) return "";
    return "        " + command.name + ") " + chooser(command.positionals.front()) + " ;;\n";
}

}  // namespace

std::string bash_completion(const OptionTable& table) {
    const std::vector<std::string> subcommands = names_of(table);
    std::string text = "# bash completion of puppetwarp " PUPPETWARP_VERSION ", made by `puppetwarp completion bash`\n";
    text += functions;
    text += "    for ((i = 1; i < COMP_CWORD; ++i)); do\n        case ${COMP_WORDS[i]} in\n            ";
    text += CLI::detail::join(subcommands, " | ") + ")\n                subcommand=${COMP_WORDS[i]}\n";
    text += "                break ;;\n        esac\n    done\n\n    case $subcommand:$previous in\n";
    ValueCases values;
    values.add(table.program, "*");
    for (const CommandRow& each : table.subcommands) values.add(each, each.name);
    text += values.text() + "    esac\n    if [[ $current == -* ]]; then\n        case $subcommand in\n";
    text += options_case("''", table.program.options, {});
    for (const CommandRow& each : table.subcommands) {
        text += options_case(each.name, each.options, global_options(table, each));
    }
    text += "        esac\n        return\n    fi\n    case $subcommand in\n";
    text += "        '') _puppetwarp_choose" + words(subcommands) + " ;;\n";
    for (const CommandRow& each : table.subcommands) text += positional_case(each);
    return text + "    esac\n}\n\ncomplete -F _puppetwarp puppetwarp\n";
}

}  // namespace puppetwarp::cli
