#include "man_page.h"

#include <algorithm>
#include <cctype>

namespace puppetwarp::cli {

namespace {

bool is_program(const CommandRow& command, const OptionTable& table) {
    return &command == &table.program;
}

// Text as man(7) wants it: a hyphen that is typed must stay one.
std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
        switch (c) {
            case '\\': result += "\\e"; break;
            case '-': result += "\\-"; break;
            case '\'': result += "\\(aq"; break;
            case '`': result += "\\(ga"; break;
            case '^': result += "\\(ha"; break;
            case '~': result += "\\(ti"; break;
            default: result += c;
        }
    }
    return result;
}

// A line that begins like a request, and is none.
std::string line_of(const std::string& text) {
    return (text.starts_with('.') ? "\\&" : "") + text + "\n";
}

// A paragraph in lines of at most 78 characters, as far as its words allow.
std::string filled(const std::string& text) {
    constexpr std::size_t most = 78;
    std::string result, line;
    for (const std::string& word : CLI::detail::split(escaped(text), ' ')) {
        if (!line.empty() && line.size() + 1 + word.size() > most) {
            result += line_of(line);
            line.clear();
        }
        line += (line.empty() ? "" : " ") + word;
    }
    return result + line_of(line);
}

std::string bold(const std::string& text) {
    return "\\fB" + escaped(text) + "\\fR";
}

std::string italic(const std::string& text) {
    return "\\fI" + escaped(text) + "\\fR";
}

// Names of options and values stay whole: no hyphens at ends of lines.
std::string section_head(const std::string& title) {
    return ".SH " + title + "\n.nh\n";
}

std::string section(const std::string& title, const std::string& body) {
    return body.empty() ? "" : section_head(title) + body;
}

std::string sentence(std::string text) {
    if (!text.empty() && text.back() != '.') text += '.';
    return text;
}

// The choices, where the description does not name them all.
std::string choices_sentence(const OptionRow& option) {
    const bool named = std::all_of(option.choices.begin(), option.choices.end(), [&](const std::string& choice) {
        return option.description.find(choice) != std::string::npos;
    });
    if (named) return "";
    std::string list;
    for (const std::string& choice : option.choices) list += (list.empty() ? "" : ", ") + choice;
    return " Known: " + list + ".";
}

std::string entry(const OptionRow& option) {
    std::string head;
    for (const std::string& name : option.names) head += (head.empty() ? "" : ", ") + bold(name);
    if (!option.value.empty()) head += (head.empty() ? "" : " ") + italic(option.value);
    std::string text = sentence(option.description) + choices_sentence(option);
    if (option.required && !option.names.empty()) text += " Required.";
    return ".TP\n" + head + "\n" + filled(text);
}

std::string entries(const std::vector<OptionRow>& options) {
    std::string text;
    for (const OptionRow& option : options) text += entry(option);
    return text;
}

std::string synopsis(const CommandRow& command, const OptionTable& table) {
    std::string text = bold(is_program(command, table) ? command.name : table.program.name + " " + command.name);
    for (const OptionRow& positional : command.positionals) {
        const std::string value = italic(positional.value) + (positional.repeated ? " ..." : "");
        text += positional.required ? " " + value : " [" + value + "]";
    }
    for (const OptionRow& option : command.options) {
        if (option.required) text += " " + bold(option.names.front()) + " " + italic(option.value);
    }
    text += " [" + italic("OPTION") + "]...";
    if (is_program(command, table)) text += "\n.br\n" + bold(command.name) + " " + italic("SUBCOMMAND") + " ...";
    return text + "\n";
}

std::string subcommands(const OptionTable& table) {
    std::string text;
    for (const CommandRow& each : table.subcommands) {
        text += ".TP\n" + bold(each.name) + "\n" + filled(sentence(each.description)) + "See " +
                bold(man_page_name(each, table)) + "(1).\n";
    }
    return text;
}

// The footer of `--help`: paragraphs, each with a title that ends in a colon and lines that are kept as they are.
std::string footer_sections(const std::string& footer) {
    std::string text;
    bool open = false;
    for (const std::string& line : CLI::detail::split(footer, '\n')) {
        const bool title = !line.empty() && line.front() != ' ' && line.back() == ':';
        if (title || line.empty()) {
            text += open ? ".EE\n" : "";
            open = false;
        }
        if (title) {
            std::string name = line.substr(0, line.size() - 1);
            std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::toupper(c); });
            text += section_head(name) + ".EX\n";
            open = true;
        } else if (!line.empty()) {
            text += line_of(escaped(line.substr(std::min<std::size_t>(2, line.find_first_not_of(' ')))));
        }
    }
    return text + (open ? ".EE\n" : "");
}

constexpr const char* exit_status =
    ".TP\n0\nDone; of\n.BR \"puppetwarp diff\" :\nsame.\n"
    ".TP\n1\nDone, but the answer is no: pictures differ, or a gate did not hold.\n"
    ".TP\n2\nThe input or the usage is at fault; one line on standard error says what,\nwhy and what to do.\n"
    ".TP\n3\nThe machine is at fault (disk full, out of memory), or the program.\n";

std::string see_also(const CommandRow& command, const OptionTable& table) {
    std::string text = is_program(command, table) ? "" : bold(table.program.name) + "(1)";
    for (const CommandRow& each : table.subcommands) {
        if (&each == &command) continue;
        text += (text.empty() ? "" : ",\n") + bold(man_page_name(each, table)) + "(1)";
    }
    return text + "\n";
}

// What stands after a name: no sentence.
std::string phrase(std::string text) {
    if (!text.empty()) text.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(text.front())));
    if (text.ends_with('.')) text.pop_back();
    return text;
}

}  // namespace

std::string man_page_name(const CommandRow& command, const OptionTable& table) {
    return is_program(command, table) ? command.name : table.program.name + "-" + command.name;
}

std::string man_page(const CommandRow& command, const OptionTable& table) {
    const std::string name = man_page_name(command, table);
    std::string title = escaped(name);
    std::transform(title.begin(), title.end(), title.begin(), [](unsigned char c) { return std::toupper(c); });
    std::string text = ".TH " + title + " 1 " PUPPETWARP_VERSION_DATE " \"puppetwarp " PUPPETWARP_VERSION "\" \"" +
                       "User Commands\"\n.ad l\n";
    text += section("NAME", escaped(name) + " \\- " + escaped(phrase(command.description)) + "\n");
    text += section("SYNOPSIS", synopsis(command, table));
    text += section("DESCRIPTION", filled(sentence(command.description)) + entries(command.positionals));
    text += section("OPTIONS", entries(command.options));
    if (is_program(command, table)) {
        text += section("SUBCOMMANDS", subcommands(table));
    } else {
        text += section("GLOBAL OPTIONS", entries(global_options(table, command)));
    }
    text += section("EXIT STATUS", exit_status);
    text += footer_sections(command.footer);
    return text + section("SEE ALSO", see_also(command, table));
}

}  // namespace puppetwarp::cli
