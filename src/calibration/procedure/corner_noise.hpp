// Standard deviations of corners relative to each other: Settings::sigma_by, and the losses of Settings::robust.
#pragma once

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/options.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Returns whether standard deviations of corners depend on the fit.
bool estimatesNoise(const Settings& settings);

/// Estimates CameraResult::noise and Result::downweighted from the residuals of a result that succeeded. `data` must
/// be sorted.
void estimateNoise(const Dataset& data, const Settings& settings, Result& result);

}  // namespace slom::calibration
