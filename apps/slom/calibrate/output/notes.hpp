// What the numbers mean for what to do next: sentences for the end of the report.
#pragma once

#include <string>
#include <vector>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// Each one a sentence or two: views that repeat others, residuals that do not fit the stated sigmas, cameras
/// that fit worse as a rig than as single cameras, what the data hardly determine, a sign of gravity that is open.
std::vector<std::string> notes(const Result& result);

}  // namespace slom::app::calib
