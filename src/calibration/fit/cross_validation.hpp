// How well a camera model predicts corners that it was not fitted to. See comparison.hpp for the definition.
#pragma once

#include <optional>
#include <vector>

#include "calibration/initialization/rig.hpp"
#include "calibration/models/lens.hpp"
#include "slom/calibration/options.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Returns the mean squared distance of the predicted corners, by image [px^2]. The fits to the folds, and the poses
/// in them, start from `cameras`, `rig` and `board` of a fit to all images. Throws slom::Error if a fold determines
/// too little, WorkEnded if the time does not suffice for all folds.
std::vector<double> heldOutSquares(const Dataset& data, const Settings& settings,
                                   const std::vector<Lens>& cameras, const RigStart& rig,
                                   const std::optional<FittedBoard>& board);

}  // namespace slom::calibration
