#pragma once
// `slom simulate`: measurements with known truth.

#include <CLI/CLI.hpp>

namespace slom::app {

/// Adds the subcommand `simulate`, with one subcommand for each device it knows, to the command line. It runs
/// while the command line is parsed; mistakes are thrown as UserError.
void addSimulateCommand(CLI::App& app);

}  // namespace slom::app
