// The way from data to result for one camera model, Settings::model, without a second look at corners and views.
#pragma once

#include "slom/calibration/calibrate.hpp"
#include "slom/calibration/comparison.hpp"

namespace slom::calibration {

/// Fits single cameras, finds start values of the rig from these, and fits all together.
Result calibrateModel(const Dataset& data, const Settings& settings, const Progress& progress);

/// Fits the rig alone, to images that are among those of an earlier result, from the values found there. An IMU is left out.
Result calibrateModelFrom(const Result& start, const Dataset& data, const Settings& settings);

/// Fits the model and predicts corners that it was not fitted to.
ModelTrial tryModel(const Dataset& data, const Settings& settings);

}  // namespace slom::calibration
