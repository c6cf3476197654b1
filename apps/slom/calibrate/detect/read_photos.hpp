// The first half of a calibration from photographs: corners, and files of them.
#pragma once

#include "calibrate/library.hpp"
#include "calibrate/settings.hpp"

namespace slom::app::calib {

/// Finds the board in the photographs of all cameras and writes the corner files that are asked for, so that
/// they are there whatever becomes of the fit. `settings.board` must be given. `numbers` gets those in the names of the files.
std::vector<CameraData> readPhotos(const CommandSettings& settings, ImageNumbers& numbers);

}  // namespace slom::app::calib
