// Whether the data can be calibrated from at all. Each function throws UserError with the first thing it
// finds.
#pragma once

#include "calibrate/input/dataset.hpp"

namespace slom::app::calib {

/// Every view can give a pose (at least four corners in a plane, not on a line), no corner
/// is there twice, every camera has two views.
void checkViews(const CameraData& camera);

/// Every camera is tied to the first one by common images, possibly through other cameras.
void checkConnected(const Dataset& data);

/// Every reading belongs to an image that some camera has.
void checkImuImages(const Dataset& data);

/// All of the above.
void checkDataset(const Dataset& data);

}  // namespace slom::app::calib
