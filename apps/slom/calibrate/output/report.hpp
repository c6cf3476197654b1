// The result as people read it.
#pragma once

#include <string>

#include "calibrate/settings.hpp"

namespace slom::app::calib {

/// What was read: cameras, images, corners, readings.
std::string dataText(const Dataset& data);

/// What comes next: each camera's own fit.
std::string aloneHeader(const CommandSettings& settings);

/// One line for a camera's own fit.
std::string singleCameraText(const SingleCameraReport& alone);

/// Everything that came out.
std::string reportText(const Result& result);

}  // namespace slom::app::calib
