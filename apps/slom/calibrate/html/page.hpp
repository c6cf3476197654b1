// The report of a calibration as one HTML page that needs no network and no other file.
#pragma once

#include <string>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// Returns the page. `result.quality` must be set.
std::string toHtml(const Dataset& data, const Result& result);

}  // namespace slom::app::calib
