// Corners that were found, as files that --camera reads.
#pragma once

#include <string>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// With all digits, so that a calibration from the file is the same as from the photographs.
std::string toCornerFile(const CameraData& camera);

}  // namespace slom::app::calib
