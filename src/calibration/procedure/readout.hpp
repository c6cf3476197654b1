// The time in which a camera reads the rows of an image one after the other (CameraResult::readout).
#pragma once

#include <optional>
#include <vector>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// The change of the readout that the residuals of a successful result suggest.
struct ReadoutStep {
  double value = 0;          ///< to add to the readout
  double std = 0;            ///< stated, with poses and all shared parameters free
  double std_clustered = 0;  ///< from up to twelve blocks of successive images
  double probability = 1;    ///< of such an effect by chance, as in ResidualPattern
  /// Derivative of each shared parameter by the readout.
  Eigen::VectorXd followed;
};

/// Returns the steps by camera; nothing for a camera whose corner motions are unknown. `data` must be sorted, without
/// the readout of the result and with its noise.
std::vector<std::optional<ReadoutStep>> readoutSteps(const Dataset& data, const Result& result);

/// Adds the effect of the unknown readout to all standard deviations, and to the clustered covariance
/// (addIndependentError).
void addUncertaintyOf(const std::vector<std::optional<ReadoutStep>>& steps, Result& result);

}  // namespace slom::calibration
