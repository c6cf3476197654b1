// The report of a calibration as one HTML page that needs nothing else: no network, no other file.
#pragma once

#include <string>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// `result.quality` must be there.
std::string toHtml(const Dataset& data, const Result& result);

}  // namespace slom::app::calib
