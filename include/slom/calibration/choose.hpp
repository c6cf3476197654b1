/// calibrateByChoice: a calibration that leaves model, shape of the board, noise and readout to comparisons.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "slom/calibration/calibrate.hpp"
#include "slom/calibration/comparison.hpp"
#include "slom/calibration/corner_noise.hpp"
#include "slom/calibration/options.hpp"
#include "slom/calibration/readout.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// The settings that comparisons choose; all others stay as they are given.
struct Choices {
  std::vector<Model> models;     ///< models to compare; empty: none
  bool model = false;            ///< whether the best of them becomes Settings::model
  bool board_shape = false;      ///< whether flat, bent and free boards are compared
  bool sigma_by = false;         ///< whether the noise may grow with speed, slant or distance
  bool rolling_shutter = false;  ///< whether rows may be read one after the other
};

/// Functions called after each step; each may be empty.
struct ChoiceProgress {
  std::function<void(const Comparison&, const Settings& chosen)> models;
  std::function<void(const Comparison&)> board_shapes;
  std::function<void(const Settings& chosen)> before_fit;
  std::function<void(const NoiseComparison&, const Result&)> noise;
  std::function<void(const std::vector<std::optional<ReadoutTrial>>&, const Result&)> readout;
  Progress fit;
};

/// Compares models, then shapes of the board, then the models on a board of the chosen shape; calibrates; and calibrates again
/// if the noise grows or rows are read one after the other. Models and shapes are compared on about 300 images of a
/// recording of more than 600. `settings` become the chosen ones. The comparisons are part of
/// the result. Throws as calibrate().
Result calibrateByChoice(const Dataset& data, Settings& settings, const Choices& choices,
                         const ChoiceProgress& progress = {});

}  // namespace slom::calibration
