// What the motion of hand and eye does not determine.
#pragma once

#include <vector>

#include "calibration/hand_eye/fit.hpp"

namespace slom::calibration {

/// Directions of the unknowns that the motion leaves free, in words too.
struct Freedom {
  Held held;
  std::vector<FreeDirection> directions;  ///< as many as held.directions
  /// The least response of the residuals to any direction that is not free, relative to that which noise alone gives. The
  /// estimates are too small by about the inverse of its square.
  double least_response = 0;
  /// Motion between two poses of the interpolated stream, relative to their noise.
  double motion_per_step = 0;
  vec3 turns_deg{0., 0., 0.};  ///< HandEyeResult::turns_deg
};

/// Finds them at the end of a fit. Noisy poses turn a little about every axis. So a direction counts as free if the
/// residuals respond to it little more than to the noise of the poses.
Freedom freedomOf(const Streams& streams, const HandEyeSettings& settings, const Items& items,
                  const HandEyeValues& values, const HandEyeNoise& noise);

}  // namespace slom::calibration
