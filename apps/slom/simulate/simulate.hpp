#pragma once
// `slom simulate`: measurements with known truth.

#include <CLI/CLI.hpp>

namespace slom::app {

/// Adds the subcommand `simulate` to the command line, with one subcommand for each simulated device. It runs while the
/// command line is parsed. Mistakes throw UserError.
void addSimulateCommand(CLI::App& app);

}  // namespace slom::app
