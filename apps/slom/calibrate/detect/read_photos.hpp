// The first half of a calibration from photographs: corners, and files of them.
#pragma once

#include "calibrate/library.hpp"
#include "calibrate/settings.hpp"

namespace slom::app::calib {

/// Finds the board in the photographs of all cameras and writes the corner files that are asked for, so that
/// they are there whatever becomes of the fit. `settings.board` must be given.
std::vector<CameraData> readPhotos(const CommandSettings& settings);

}  // namespace slom::app::calib
