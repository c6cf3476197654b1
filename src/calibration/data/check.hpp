// Whether the data can be calibrated from at all. Each function throws DataError with the first thing it
// finds.
#pragma once

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/options.hpp"

namespace slom::calibration {

/// Every view can give a pose (at least four corners in a plane, not on a line), no corner
/// is there twice, every camera has two views.
void checkViews(const CameraData& camera);

/// Every camera is tied to the first one by common images, possibly through other cameras.
void checkConnected(const Dataset& data);
/// Whether that holds, and an IMU that is there has readings: of data without some views.
bool isStillConnected(const Dataset& rest);

/// Every reading belongs to an image that some camera has.
void checkImuImages(const Dataset& data);

/// Each standard deviation and limit makes sense, and constraints are about parameters and cameras that there are.
void checkSettings(const Dataset& data, const Settings& settings);

/// All of the above that concerns the data, which are well formed (well_formed.hpp).
void checkDataset(const Dataset& data);

}  // namespace slom::calibration
