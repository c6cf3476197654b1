// Settings from the command line.
#pragma once

#include <optional>
#include <string>

#include "fitting/checkpoints.hpp"
#include "fitting/console.hpp"
#include "fitting/fit_options.hpp"
#include "graph/fit/model.hpp"
#include "graph/initialization/start.hpp"
#include "graph/online/online.hpp"

namespace slom::app::graph {

struct Settings {
  std::string file;
  FitOptions fit;
  std::optional<Start> init;  ///< none: the one with the lowest RSS
  RotationError rotation_error = RotationError::vector;
  Online online = Online::no;
  bool repair_information = false;
  bool hold_parts = false;
  std::string output_file;  ///< empty: none
  std::string plot_file;    ///< empty: none
  ReportOptions report;
  CheckpointOptions checkpoint;

  GraphModel model() const { return {fit, rotation_error}; }
};

/// The options as text from CLI11.
struct RawOptions {
  RawFitOptions fit;
  std::string init = "auto";
  std::string rotation_error = "vector";
  std::string online;
  Settings rest;
};

/// Returns the options of fits within limits, which print their iterations.
Options optionsOf(const Settings& settings, const Console& console);

/// Reads the texts and checks all values. Throws UserError that names the option.
Settings parseSettings(const RawOptions& raw);

}  // namespace slom::app::graph
