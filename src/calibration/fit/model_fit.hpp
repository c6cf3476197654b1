// The fit of one camera model, Settings::model, from data to result, without a second look at corners and views.
#pragma once

#include "calibration/fit/single_camera.hpp"
#include "slom/calibration/calibrate.hpp"
#include "slom/calibration/comparison.hpp"

namespace slom::calibration {

/// Fits single cameras, finds start values of the rig from these, and fits all together.
Result calibrateModel(const Dataset& data, const Settings& settings, const Progress& progress);

/// Fits the rig, starting from an earlier result whose images include those of the data, until a step changes no unknown
/// by more than `tolerance` standard deviations. Leaves out an IMU. From rough_deviations on, the standard deviations are
/// those of the earlier result.
Result calibrateModelFrom(const Result& start, const Dataset& data, const Settings& settings,
                          double tolerance = enough_deviations);

/// Fits the model and predicts corners that it was not fitted to.
ModelTrial tryModel(const Dataset& data, const Settings& settings);

}  // namespace slom::calibration
