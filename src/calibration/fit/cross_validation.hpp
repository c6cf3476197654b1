// How well a camera model predicts corners that it was not fitted to; comparison.hpp says how that is
// defined.
#pragma once

#include <optional>
#include <vector>

#include "calibration/initialization/rig.hpp"
#include "calibration/models/lens.hpp"
#include "slom/calibration/options.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Mean squared distance of the predicted corners, by image [px^2]. `cameras`, `rig` and `board` are those of a fit to
/// all images: where the fits to the folds, and poses in them, start. slom::Error when a fold determines too
/// little, WorkEnded when there is no time left for all folds.
std::vector<double> heldOutSquares(const Dataset& data, const Settings& settings,
                                   const std::vector<Lens>& cameras, const RigStart& rig,
                                   const std::optional<FittedBoard>& board);

}  // namespace slom::calibration
