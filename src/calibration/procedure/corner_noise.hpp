// Standard deviations of corners beside each other: Settings::sigma_by, and the losses of Settings::robust.
#pragma once

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/options.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Whether standard deviations of corners depend on the fit.
bool estimatesNoise(const Settings& settings);

/// Estimates CameraResult::noise and Result::downweighted from the residuals of a result that succeeded. `data` is sorted.
void estimateNoise(const Dataset& data, const Settings& settings, Result& result);

}  // namespace slom::calibration
