// `slom hand-eye`: where a camera sits on a hand.
#pragma once

#include <CLI/CLI.hpp>

namespace slom::app {

/// Adds the subcommand `hand-eye` to the command line. It runs while the command line is parsed. Mistakes throw
/// UserError or the library's errors; a calibration that failed ends with CLI::RuntimeError.
void addHandEyeCommand(CLI::App& app);

}  // namespace slom::app
