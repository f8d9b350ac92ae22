#include "command.h"

#include "terminal.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/progress.h>
#include <puppetwarp/base/threads.h>

#include <algorithm>
#include <iostream>
#include <new>

namespace puppetwarp::cli {

namespace {

// Which subcommand's help to point at after a mistake in its options.
std::string help_hint(const CLI::App& app) {
    const auto subcommands = app.get_subcommands();
    return subcommands.empty() ? "see puppetwarp --help"
                               : "see puppetwarp " + subcommands.front()->get_name() + " --help";
}

// The option parser's own complaint, as the one line that all errors are.
int complain_of_usage(const CLI::App& app, const CLI::ParseError& error) {
    std::string reason = error.what();
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    print_error("usage: " + reason + " (" + help_hint(app) + ")");
    return user_error;
}

void add_global_options(CLI::App& app, GlobalOptions& global) {
    app.set_version_flag("--version", "puppetwarp " PUPPETWARP_VERSION, "Print the version");
    app.add_option("-j,--threads", global.threads, "Threads to use, 1 to 1024 (default: all cores)")
        ->type_name("N")
        ->check(CLI::Range(1, 1024));
    app.add_flag("-q,--quiet", global.quiet, "No progress, no warnings, no summary");
    app.add_flag("-v,--verbose", global.verbose, "Tell what each stage took");
    app.set_help_flag("-h,--help", "Print this help");
    app.fallthrough();
    app.require_subcommand(0, 1);
    app.allow_extras(false);
}

}  // namespace

CLI::App* add_subcommand(CLI::App& app, const std::string& name, const std::string& description,
                         const std::string& example) {
    CLI::App* subcommand = app.add_subcommand(name, description);
    subcommand->footer("Example:\n  " + example);
    return subcommand;
}

int run(int argc, const char* const* argv) {
    CLI::App app("Warps pictures through handles: cut out, triangulate, drag, draw.", "puppetwarp");
    GlobalOptions global;
    int exit_code = done;
    try {
        add_global_options(app, global);
        app.parse_complete_callback([&] { set_thread_count(global.threads); });
        add_warp_command(app, global, exit_code);
        add_mesh_command(app, global, exit_code);
        add_deform_command(app, global, exit_code);
        add_weights_command(app, global, exit_code);
        add_diff_command(app, global, exit_code);
        add_compare_command(app, global, exit_code);
        add_info_command(app, global, exit_code);
        add_schema_command(app, global, exit_code);
        add_completion_command(app, global, exit_code);
        add_man_command(app, global, exit_code);
        app.footer("Example:\n  puppetwarp warp photo.jpg --pin 100,200 --pin 320,90:360,40 -o out.jpg");
        app.parse(argc, argv);
        if (app.get_subcommands().empty()) {
            throw InvalidInput("usage", "no subcommand is given", "see puppetwarp --help");
        }
        std::cout.flush();
        if (!std::cout) throw MachineFault("standard output", "cannot be written");
        return exit_code;
    } catch (const CLI::Success& success) {  // --help and --version
        const int code = app.exit(success);
        if (std::cout.flush()) return code;
        print_error("standard output: cannot be written");
        return machine_fault;
    } catch (const CLI::ParseError& error) {
        return complain_of_usage(app, error);
    } catch (const InvalidInput& error) {
        print_error(error.what());
        return user_error;
    } catch (const MachineFault& error) {
        print_error(error.what());
        return machine_fault;
    } catch (const std::bad_alloc&) {
        print_error("memory: there is not enough of it (use a smaller picture or a coarser mesh)");
        return machine_fault;
    } catch (const std::exception& error) {
        print_error(std::string("internal error: ") + error.what());
        return machine_fault;
    }
}

}  // namespace puppetwarp::cli
