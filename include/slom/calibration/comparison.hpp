/// Several camera models on the same data, or several shapes of the board: which one they carry.
///
/// A model with more parameters always fits better; whether it also predicts better is seen on images that it
/// was not fitted to. The images are dealt into folds. For each fold lenses and camera to camera are fitted to
/// the images of the others, and fixed. In each image of the fold the pose of the board is fitted to every
/// other corner, and the remaining corners are predicted; then the other way round. So every corner is
/// predicted once, by values that it had no part in. The IMU is left out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/error.hpp"
#include "slom/calibration/options.hpp"

namespace slom::calibration {

/// One model on all images, and in cross-validation.
struct ModelTrial {
  Model model;
  BoardShape board_shape = BoardShape::flat;
  std::string failure{};             ///< why there is no fit, or none that can be used; empty otherwise
  std::optional<DataError> error{};  ///< whose sentence that is, if it is one's
  int unknowns = 0, redundancy = 0;
  double rss = 0;
  double rms_px = 0;                       ///< over the corners of all cameras
  std::vector<double> held_out_squares{};  ///< by image: mean squared distance of predicted corners [px^2]

  /// Root mean square distance of the predicted corners, over all images [px].
  double heldOutRms() const;
};

/// What comes out of a comparison of models, or of shapes of the board.
struct Comparison {
  std::vector<ModelTrial> trials;   ///< as they were asked for
  std::optional<std::size_t> best;  ///< predicts best
  std::optional<std::size_t>
      chosen;  ///< has the fewest parameters of those that predict worse by two standard errors at most
  std::vector<double>
      standard_errors;  ///< difference of its prediction from the best one, in standard errors; NaN without a fit

  std::string cut_short;  ///< empty, or why some were not tried to the end

  /// DataError [slom.calibration.no-result] where none is chosen.
  const ModelTrial& chosenTrial() const;
};

/// Fits each model, of one at least. A failure of one, as on a fisheye's images by a pinhole, is noted in its trial; so
/// it is when the time is over.
Comparison compareModels(const Dataset& data, const Settings& settings, const std::vector<Model>& models);

/// The same of one model, Settings::model, with a flat, a bent and a free board. The shape is fitted without the images of a fold, and fixed, as lenses
/// are.
Comparison compareBoardShapes(const Dataset& data, const Settings& settings);

}  // namespace slom::calibration
