// `slom convert`: text files as containers and back.
#pragma once

#include <CLI/CLI.hpp>

namespace slom::app {

/// Adds the subcommand `convert` to the command line. It runs while the command line is parsed. Mistakes throw
/// UserError.
void addConvertCommand(CLI::App& app);

}  // namespace slom::app
