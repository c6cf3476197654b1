// What the user asked for on the command line.
#pragma once

#include <optional>
#include <string>

#include "fitting/console.hpp"
#include "fitting/fit_options.hpp"
#include "graph/start/start.hpp"

namespace slom::app::graph {

/// What the three rotational components of an edge's error in space are.
enum class RotationError {
  vector,     ///< the rotation vector, axis times angle [rad]
  quaternion  ///< the vector part of the unit quaternion with w >= 0, as in g2o
};

struct Settings {
  std::string file;
  FitOptions fit;
  std::optional<Init> init;  ///< none: file where it has vertices, spanning_tree otherwise
  RotationError rotation_error = RotationError::vector;
  bool repair_information = false;
  bool hold_parts = false;
  std::string output_file;  ///< empty: none
  std::string plot_file;    ///< empty: none
  ReportOptions report;
};

/// The options as text, as CLI11 hands them over.
struct RawOptions {
  RawFitOptions fit;
  std::string init;
  std::string rotation_error = "vector";
  Settings rest;
};

/// Reads the texts and checks all values; UserError names the option.
Settings parseSettings(const RawOptions& raw);

}  // namespace slom::app::graph
