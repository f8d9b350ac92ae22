#include "command.h"

#include <puppetwarp/project/puppet_schema.h>

#include <iostream>

namespace puppetwarp::cli {

void add_schema_command(CLI::App& app, const GlobalOptions& /*global*/, int& /*exit_code*/) {
    CLI::App* schema =
        add_subcommand(app, "schema", "Print the JSON Schema (draft 2020-12) of the puppet file: keys, units, ranges",
                       "puppetwarp schema > puppet.schema.json");
    schema->callback([] { std::cout << puppet_schema(); });
}

}  // namespace puppetwarp::cli
