#include "command.h"
#include "completion.h"

#include <iostream>
#include <memory>

namespace puppetwarp::cli {

void add_completion_command(CLI::App& app, const GlobalOptions& /*global*/, int& /*exit_code*/) {
    CLI::App* completion =
        add_subcommand(app, "completion", "Print a script that completes this command's words in a shell",
                       "puppetwarp completion bash > ~/.local/share/bash-completion/completions/puppetwarp\n"
                       "  puppetwarp completion zsh > ~/.zfunc/_puppetwarp\n"
                       "  puppetwarp completion fish > ~/.config/fish/completions/puppetwarp.fish");
    const auto shell = std::make_shared<std::string>();
    completion->add_option("shell", *shell, "bash, zsh or fish")
        ->required()
        ->type_name("SHELL")
        ->check(CLI::IsMember({"bash", "zsh", "fish"}));
    completion->callback([shell, &app] {
        const OptionTable table = option_table(app);
        std::cout << (*shell == "bash"  ? bash_completion(table)
                      : *shell == "zsh" ? zsh_completion(table)
                                        : fish_completion(table));
    });
}

}  // namespace puppetwarp::cli
