// Fits of hand and eye that find the noise, and leave out what contradicts the others.
#pragma once

#include <vector>

#include "calibration/hand_eye/fit.hpp"

namespace slom::calibration {

/// The least number of rows or motions with which a fit is tried.
inline constexpr std::size_t least_items = 3;

/// A fit that knows which items contradict the others.
struct RobustFit {
  HandEyeValues values;
  HandEyeNoise noise;
  Items items;                ///< all rows or motions at these values
  std::vector<bool> is_good;  ///< by item
  double block_s = 0;         ///< blocks of time of clustered standard deviations

  Items goodItems() const;
};

/// Fits with a loss from the start values; then without the outliers, until they stay the same. Holds directions that are
/// free.
RobustFit fitRobustly(const Streams& streams, const HandEyeSettings& settings, const HandEyeValues& start,
                      const Held& held);

/// Returns the fit of round 0: the start values, with all items and the noise that most show.
RobustFit unfitted(const Streams& streams, const HandEyeSettings& settings, const HandEyeValues& start);

/// Returns the problem of the last fit, with the noise by variance components, and sets that of `fit`.
HandEyeProblem finalProblem(const Streams& streams, const HandEyeSettings& settings, RobustFit& fit,
                            const Held& held);

}  // namespace slom::calibration
