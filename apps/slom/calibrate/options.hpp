// The options of `slom calibrate`, and the texts of its help.
#pragma once

#include <CLI/CLI.hpp>

#include "calibrate/settings.hpp"

namespace slom::app::calib {

/// Adds all options to the subcommand. `raw` must outlive it. Returns --compare, which may have no value.
CLI::Option* addOptions(CLI::App& command, RawOptions& raw);

}  // namespace slom::app::calib
