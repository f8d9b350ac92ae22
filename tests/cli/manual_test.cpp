// Manual pages and completions say what `--help` says: every subcommand, every option, every name of a value.

#include "support/run_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <set>
#include <sstream>

namespace puppetwarp::tests {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;
using Words = std::set<std::string>;

std::string printed(const std::vector<std::string>& arguments) {
    const CommandResult result = puppetwarp_command(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(result.errors, "");
    return result.output;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

// The words that begin the entries of `--help` under a title: `-o,--output OUT` is two.
Words entries(const std::string& help, const std::string& title) {
    Words found;
    bool inside = false;
    const std::regex entry("^  (\\S+).*");
    for (const std::string& line : lines_of(help)) {
        if (line.empty() || line.back() == ':') inside = line == title;
        std::smatch match;
        if (!inside || !std::regex_match(line, match, entry)) continue;
        std::istringstream names(match[1]);
        for (std::string name; std::getline(names, name, ',');) found.insert(name);
    }
    return found;
}

Words subcommands() {
    return entries(printed({"--help"}), "Subcommands:");
}
Words global_options() {
    return entries(printed({"--help"}), "Options:");
}
Words options_of(const std::string& subcommand) {
    return entries(printed({subcommand, "--help"}), "Options:");
}

TEST(Manual, HelpIsReadAsItIsMeant) {
    EXPECT_THAT(subcommands(), testing::IsSupersetOf({"warp", "diff", "info", "schema", "man", "completion"}));
    EXPECT_EQ(global_options(),
              Words({"--version", "-j", "--threads", "-q", "--quiet", "-v", "--verbose", "-h", "--help"}));
    EXPECT_THAT(options_of("warp"), testing::IsSupersetOf({"-o", "--output", "--pin", "--method", "--json"}));
}

class ManPage : public testing::Test {
protected:
    // The page as text, its markup taken away.
    static std::string plain(const std::vector<std::string>& arguments) {
        std::string page = printed(arguments);
        page = std::regex_replace(page, std::regex(R"(\\f[BIR])"), "");
        page = std::regex_replace(page, std::regex(R"(\\-)"), "-");
        page = std::regex_replace(page, std::regex(R"(\\\(ti)"), "~");
        return std::regex_replace(page, std::regex(R"(\\\(aq)"), "'");
    }
    // A page's entries: the lines after `.TP`.
    static Words options_on(const std::string& page) {
        Words found;
        const std::vector<std::string> lines = lines_of(page);
        const std::regex name("(^|, )(--?[A-Za-z0-9-]+)");
        for (std::size_t i = 1; i < lines.size(); ++i) {
            if (lines[i - 1] != ".TP" || lines[i].front() != '-') continue;
            for (std::sregex_iterator each(lines[i].begin(), lines[i].end(), name), end; each != end; ++each) {
                found.insert((*each)[2]);
            }
        }
        return found;
    }
};

TEST_F(ManPage, HasEveryOptionOfTheHelp) {
    EXPECT_EQ(options_on(plain({"man"})), global_options());
    for (const std::string& subcommand : subcommands()) {
        Words expected = options_of(subcommand);
        expected.merge(global_options());
        EXPECT_EQ(options_on(plain({"man", subcommand})), expected) << subcommand;
    }
}

TEST_F(ManPage, NamesEverySubcommandAndSaysWhatItIs) {
    const std::string program = plain({"man"});
    for (const std::string& subcommand : subcommands()) {
        EXPECT_THAT(program, HasSubstr(".TP\n" + subcommand + "\n"));
        EXPECT_THAT(program, HasSubstr("puppetwarp-" + subcommand + "(1)"));
        const std::string page = plain({"man", subcommand}), help = printed({subcommand, "--help"});
        for (const char* section :
             {"NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "GLOBAL OPTIONS", "EXIT STATUS", "EXAMPLE", "SEE ALSO"}) {
            EXPECT_THAT(page, HasSubstr("\n.SH " + std::string(section) + "\n")) << subcommand;
        }
        const std::string description = lines_of(help).front();
        EXPECT_THAT(page, HasSubstr("puppetwarp-" + subcommand + " - " +
                                    std::string(1, static_cast<char>(std::tolower(description[0]))) +
                                    description.substr(1) + "\n"));
        const std::vector<std::string> help_lines = lines_of(help);
        const auto example = std::find(help_lines.begin(), help_lines.end(), "Example:");
        ASSERT_NE(example, help_lines.end()) << subcommand;
        EXPECT_NE(page.find((example + 1)->substr(2)), std::string::npos) << *(example + 1);
    }
    EXPECT_THAT(plain({"man", "warp"}), HasSubstr("puppetwarp warp IMAGE|PUPPET -o OUT [OPTION]..."));
}

TEST_F(ManPage, IsCleanMarkup) {
    ASSERT_TRUE(fs::exists("/usr/bin/groff")) << "install groff-base";
    const TemporaryFolder folder;
    EXPECT_EQ(printed({"man", "--all", folder / "man1"}), "");
    Words pages;
    for (const auto& entry : fs::directory_iterator(folder.path() / "man1")) {
        const std::string page = entry.path();
        pages.insert(entry.path().stem());
        const std::string text = bytes_of(page);
        EXPECT_TRUE(std::all_of(text.begin(), text.end(), [](unsigned char c) { return c < 128; })) << page;
        const CommandResult groff = run_command({"/usr/bin/groff", "-man", "-Tutf8", "-ww", "-P-cbou", page});
        EXPECT_EQ(groff.errors, "");
        EXPECT_NE(groff.output.find("SYNOPSIS"), std::string::npos);
        if (fs::exists("/usr/bin/mandoc")) {
            EXPECT_EQ(run_command({"/usr/bin/mandoc", "-Tlint", "-W", "warning", page}).output, "");
        }
    }
    Words expected{"puppetwarp"};
    for (const std::string& subcommand : subcommands()) expected.insert("puppetwarp-" + subcommand);
    EXPECT_EQ(pages, expected);
    EXPECT_EQ(bytes_of(folder / "man1/puppetwarp-warp.1"), printed({"man", "warp"}));
}

class BashCompletion : public testing::Test {
protected:
    BashCompletion() {
        put_bytes(folder / "completion", printed({"completion", "bash"}));
        put_bytes(folder / "photo.png", "x");
        put_bytes(folder / "my rig.json", "x");
        fs::create_directory(folder / "photos");
    }

    // What bash offers for the last word of a line; `--option=value` is three words to it.
    std::vector<std::string> complete(std::vector<std::string> line) const {
        const std::string script = R"(cd "$0" && . ./completion
            COMP_WORDS=(puppetwarp "$@") COMP_CWORD=$#
            _puppetwarp
            if ((${#COMPREPLY[@]})); then printf '%s\n' "${COMPREPLY[@]}"; fi)";
        line.insert(line.begin(), {"/bin/bash", "--norc", "-c", script, folder.path()});
        const CommandResult result = run_command(line);
        EXPECT_EQ(result.errors, "");
        std::vector<std::string> words = lines_of(result.output);
        std::sort(words.begin(), words.end());
        return words;
    }
    Words offered(const std::vector<std::string>& line) const {
        const std::vector<std::string> words = complete(line);
        return {words.begin(), words.end()};
    }

    TemporaryFolder folder;
};

TEST_F(BashCompletion, OffersSubcommandsAndEveryOptionOfTheHelp) {
    EXPECT_EQ(offered({""}), subcommands());
    EXPECT_THAT(complete({"w"}), ElementsAre("warp", "weights"));
    EXPECT_EQ(offered({"-"}), global_options());
    for (const std::string& subcommand : subcommands()) {
        Words expected = options_of(subcommand);
        expected.merge(global_options());
        EXPECT_EQ(offered({subcommand, "-"}), expected) << subcommand;
        EXPECT_EQ(offered({"-j", "2", subcommand, "-"}), expected) << subcommand;
    }
    EXPECT_THAT(complete({"warp", "--ou"}), ElementsAre("--output"));
}

TEST_F(BashCompletion, OffersTheNamesOfValues) {
    EXPECT_THAT(complete({"warp", "--method", "mls"}), ElementsAre("mls-affine", "mls-rigid", "mls-similarity"));
    EXPECT_THAT(complete({"deform", "--method", "=", "fold"}), ElementsAre("fold-free"));
    EXPECT_THAT(complete({"warp", "--arap-energy", "=", ""}), ElementsAre("elements", "spokes", "spokes-and-rims"));
    EXPECT_THAT(complete({"weights", "--kind", "b"}), ElementsAre("bbw", "biharmonic"));
    EXPECT_THAT(complete({"warp", "--interpolation", "bi"}), ElementsAre("bicubic", "bilinear"));
    EXPECT_THAT(complete({"compare-methods", "--show", ""}), ElementsAre("distortion", "picture"));
    EXPECT_THAT(complete({"completion", ""}), ElementsAre("bash", "fish", "zsh"));
    EXPECT_EQ(offered({"man", ""}), subcommands());
    EXPECT_THAT(complete({"warp", "--pin", ""}), IsEmpty());  // coordinates are nobody's guess
}

TEST_F(BashCompletion, OffersTheRestOfAList) {
    EXPECT_THAT(complete({"warp", "--overlay", ""}), ElementsAre("handles", "mesh"));
    EXPECT_THAT(complete({"warp", "--overlay", "mesh,"}), ElementsAre("mesh,handles"));
    EXPECT_THAT(complete({"compare-methods", "--methods", "arap,fold"}), ElementsAre("arap,fold-free"));
}

TEST_F(BashCompletion, OffersFiles) {
    EXPECT_THAT(complete({"warp", "ph"}), ElementsAre("photo.png", "photos"));
    EXPECT_THAT(complete({"warp", "photo.png", "-o", "my"}), ElementsAre("my rig.json"));
    EXPECT_THAT(complete({"diff", "photo.png", "p"}), ElementsAre("photo.png", "photos"));
    EXPECT_THAT(complete({"diff", "a", "b", "--report", "=", "photo."}), ElementsAre("photo.png"));
    EXPECT_THAT(complete({"info", "none"}), IsEmpty());
}

// The other shells' scripts have the same words. They are tried in their shells where these are installed.
class OtherShells : public testing::TestWithParam<std::string> {};

TEST_P(OtherShells, HaveEveryOptionAndName) {
    const std::string script = printed({"completion", GetParam()});
    const auto has = [&](const std::string& option) {
        if (GetParam() == "zsh") return std::regex_search(script, std::regex("['{,]" + option + "['},\\[]"));
        const std::string flag = option.starts_with("--") ? " -l " + option.substr(2) : " -s " + option.substr(1);
        return script.find(flag + " ") != std::string::npos;
    };
    for (const std::string& option : global_options()) EXPECT_TRUE(has(option)) << option;
    for (const std::string& subcommand : subcommands()) {
        EXPECT_THAT(script, HasSubstr(subcommand));
        for (const std::string& option : options_of(subcommand)) EXPECT_TRUE(has(option)) << subcommand << option;
    }
    EXPECT_THAT(script, HasSubstr("spokes spokes-and-rims"));
    EXPECT_THAT(script, HasSubstr("mls-affine mls-similarity mls-rigid"));
}

TEST_P(OtherShells, ReadTheirScript) {
    const std::string shell = "/usr/bin/" + GetParam();
    if (!fs::exists(shell)) GTEST_SKIP() << GetParam() << " is not installed";
    const TemporaryFolder folder;
    put_bytes(folder / "script", printed({"completion", GetParam()}));
    const CommandResult result = run_command({shell, "-n", folder / "script"});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.errors, "");
}

INSTANTIATE_TEST_SUITE_P(All, OtherShells, testing::Values("zsh", "fish"),
                         [](const auto& tested) { return tested.param; });

TEST(Manual, RefusesWhatItDoesNotKnow) {
    const TemporaryFolder folder;
    put_bytes(folder / "file", "in the way");
    for (const std::vector<std::string>& arguments :
         std::vector<std::vector<std::string>>{{"completion", "tcsh"},
                                               {"completion"},
                                               {"man", "dance"},
                                               {"man", "warp", "--all", folder / "pages"},
                                               {"man", "--all", folder / "file/pages"},
                                               {"schema", "more"}}) {
        const CommandResult result = puppetwarp_command(arguments);
        EXPECT_EQ(result.exit_code, 2) << result.errors;
        EXPECT_THAT(result.errors, StartsWith("puppetwarp: "));
        EXPECT_EQ(lines_of(result.errors).size(), 1u) << result.errors;
        EXPECT_EQ(result.output, "");
    }
    EXPECT_THAT(puppetwarp_command({"man", "dance"}).errors, Not(HasSubstr("internal error")));
}

}  // namespace
}  // namespace puppetwarp::tests
