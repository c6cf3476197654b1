// `slom bundle`: bundle adjustment.
#pragma once

#include <CLI/CLI.hpp>

namespace slom::app {

/// Adds the subcommand `bundle` to the command line. It runs while the command line is parsed. Mistakes throw
/// UserError; a fit that did not converge ends with CLI::RuntimeError.
void addBundleCommand(CLI::App& app);

}  // namespace slom::app
