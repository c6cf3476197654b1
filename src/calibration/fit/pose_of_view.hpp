// The pose of the board in one view, for a known lens.
#pragma once

#include "calibration/models/lens.hpp"
#include "slom/calibration/dataset.hpp"

namespace slom::calibration {

/// The effort of the search for a pose: 40 steps to the last digit, or 12 to three digits.
enum class Look { careful, quick };

struct FittedPose {
  SE3 world2camera;
  double
      square;  ///< sum of squared distances between corners and pixels [px^2]; infinite if a corner has no image
};

/// Returns the pose with the least sum of squares, or the start if no step improves it. Takes corners as equally
/// accurate. Uses Gauss-Newton with step control: an Estimator for each pose executes four times as many instructions.
FittedPose fittedPose(const Lens& lens, const View& view, const SE3& start, Look look);

}  // namespace slom::calibration
