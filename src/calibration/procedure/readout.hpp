// The time in which a camera reads out the rows of an image one after the other (CameraResult::readout).
#pragma once

#include <optional>
#include <vector>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// What the residuals of a result that succeeded say beside its values.
struct ReadoutStep {
  double value = 0;          ///< to be added
  double std = 0;            ///< stated, with poses and all shared parameters free
  double std_clustered = 0;  ///< of up to twelve blocks of successive images
  double probability = 1;    ///< of as much by chance, as in ResidualPattern
  /// By how much each shared parameter follows a unit of it.
  Eigen::VectorXd followed;
};

/// By camera; nothing where no motion of corners is known. `data` is sorted, without the readout of the result and with its noise.
std::vector<std::optional<ReadoutStep>> readoutSteps(const Dataset& data, const Result& result);

/// Adds what the unknown readout makes to all standard deviations, and to the clustered covariance (addIndependentError).
void addUncertaintyOf(const std::vector<std::optional<ReadoutStep>>& steps, Result& result);

}  // namespace slom::calibration
