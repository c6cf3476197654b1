// The options of `slom calibrate`, and what its help says.
#pragma once

#include <CLI/CLI.hpp>

#include "calibrate/settings.hpp"

namespace slom::app::calib {

/// Adds all options to the subcommand. `raw` must live as long. Returns --compare, which may stand without a value.
CLI::Option* addOptions(CLI::App& command, RawOptions& raw);

}  // namespace slom::app::calib
