// The first half of a calibration from photographs: finding corners, and writing corner files.
#pragma once

#include "calibrate/library.hpp"
#include "calibrate/settings.hpp"

namespace slom::app::calib {

/// Finds the board in the photographs of all cameras. Writes the requested corner files, so that they exist even if
/// the fit fails. `settings.board` must be given. `numbers` receives the numbers in the names of the files.
std::vector<CameraData> readPhotos(const CommandSettings& settings, ImageNumbers& numbers);

}  // namespace slom::app::calib
