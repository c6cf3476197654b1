// Checks whether the data allow a calibration. Each function throws DataError with the first fault it finds.
#pragma once

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/options.hpp"

namespace slom::calibration {

/// Checks that every view can give a pose (at least four corners in a plane, not on a line), that no corner is there
/// twice, and that every camera has two views.
void checkViews(const CameraData& camera);

/// Checks that common images connect every camera to the first one, possibly through other cameras.
void checkConnected(const Dataset& data);
/// Returns whether data without some views are still connected, and their IMU, if any, still has readings.
bool isStillConnected(const Dataset& rest);

/// Checks that every reading belongs to an image of some camera.
void checkImuImages(const Dataset& data);

/// Checks that each standard deviation and limit is possible, and that constraints name existing parameters and
/// cameras.
void checkSettings(const Dataset& data, const Settings& settings);

/// Makes all checks above that concern the data. The data must be well formed (well_formed.hpp).
void checkDataset(const Dataset& data);

}  // namespace slom::calibration
