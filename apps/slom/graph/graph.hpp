#pragma once
// `slom graph`: fits pose graphs.

#include <CLI/CLI.hpp>

namespace slom::app {

/// Adds the subcommand `graph` to the command line. It runs while the command line is parsed. Mistakes throw UserError;
/// a fit that did not converge ends with CLI::RuntimeError.
void addGraphCommand(CLI::App& app);

}  // namespace slom::app
