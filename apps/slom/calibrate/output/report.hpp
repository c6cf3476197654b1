// The result as text for people.
#pragma once

#include <string>

#include "calibrate/settings.hpp"

namespace slom::app::calib {

/// Returns a summary of the data: cameras, images, corners, readings.
std::string dataText(const Dataset& data);

/// Returns the header before the fits of single cameras.
std::string aloneHeader(const CommandSettings& settings);

/// Returns one line about a camera's own fit.
std::string singleCameraText(const SingleCameraReport& alone);

/// Returns the whole report.
std::string reportText(const Result& result, const char* heading_of_verdict = "verdict");

}  // namespace slom::app::calib
