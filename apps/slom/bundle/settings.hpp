// Settings from the command line.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "fitting/checkpoints.hpp"
#include "fitting/console.hpp"
#include "fitting/fit_options.hpp"

namespace slom::app::bundle {

/// The algorithm for all scenes. Their place, rotation and scale are free; its damping keeps them where they are.
inline constexpr std::string_view kAlgorithm = "lm";

struct Settings {
  std::string file;
  FitOptions fit;
  double tolerance = 1e-5;                ///< relative decrease of the RSS below which the fit has converged
  std::vector<std::string> output_files;  ///< BAL or PLY, by extension
  ReportOptions report;
  CheckpointOptions checkpoint;
};

/// The options as text from CLI11.
struct RawOptions {
  RawFitOptions fit{.algorithm = std::string(kAlgorithm),
                    .solver = solvers().front().name,
                    .loss = "",
                    .threads = 0,
                    .max_iterations = {}};
  Settings rest;
};

/// Returns the options of fits within limits, which print their iterations.
Options optionsOf(const Settings& settings, const Console& console);

/// Reads the texts and checks all values. Throws UserError that names the option.
Settings parseSettings(const RawOptions& raw);

}  // namespace slom::app::bundle
