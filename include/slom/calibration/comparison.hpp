/// Comparison of several camera models, or several shapes of the board, on the same data: which one do the data
/// support?
///
/// A model with more parameters always fits better. Whether it also predicts better shows on images that it was not
/// fitted to. The images are divided into folds. For each fold, lenses and poses between cameras are fitted to the
/// images of the other folds, and fixed. In each image of the fold, the pose of the board is fitted to every other
/// corner, and the remaining corners are predicted. Then the two halves of the corners change roles. So every corner
/// is predicted once, by values to which it did not contribute. The IMU is not used.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/error.hpp"
#include "slom/calibration/options.hpp"

namespace slom::calibration {

/// One model on all images and in cross-validation.
struct ModelTrial {
  Model model;
  BoardShape board_shape = BoardShape::flat;
  std::string failure{};             ///< reason why there is no fit, or no usable one; empty otherwise
  std::optional<DataError> error{};  ///< the error that the sentence comes from, if any
  int unknowns = 0, redundancy = 0;
  double rss = 0;
  double rms_px = 0;                       ///< over the corners of all cameras
  std::vector<double> held_out_squares{};  ///< by image: mean squared distance of predicted corners [px^2]

  /// Returns the root mean square distance of the predicted corners over all images [px].
  double heldOutRms() const;
};

/// Result of a comparison of models or of shapes of the board.
struct Comparison {
  std::vector<ModelTrial> trials;   ///< in the requested order
  std::optional<std::size_t> best;  ///< trial with the best prediction
  /// Trial with the fewest parameters among those whose prediction is at most 2 standard errors worse than the best.
  std::optional<std::size_t> chosen;
  /// Difference of each prediction from the best one, in standard errors; NaN without a fit.
  std::vector<double> standard_errors;

  std::string cut_short;  ///< empty, or the reason why some trials are incomplete

  /// Returns the chosen trial. Throws DataError [slom.calibration.no-result] if none is chosen.
  const ModelTrial& chosenTrial() const;
};

/// Fits each of the models, at least one. If a model fails, such as a pinhole on images of a fisheye, or if the time
/// is over, its trial has the reason.
Comparison compareModels(const Dataset& data, const Settings& settings, const std::vector<Model>& models);

/// Compares a flat, a bent and a free board with one model, Settings::model. Like lenses, the shape is fitted without
/// the images of a fold, and fixed.
Comparison compareBoardShapes(const Dataset& data, const Settings& settings);

}  // namespace slom::calibration
