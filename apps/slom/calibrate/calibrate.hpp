// `slom calibrate`: cameras, and an IMU on their rig, from corners of a level board.
#pragma once

#include <CLI/CLI.hpp>

namespace slom::app {

/// Adds the subcommand. It runs while the command line is parsed. Mistakes are thrown as UserError, and a fit that
/// did not converge as CLI::RuntimeError(exit_not_converged), after its report.
void addCalibrateCommand(CLI::App& app);

}  // namespace slom::app
