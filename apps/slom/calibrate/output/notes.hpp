// Notes at the end of the report: what the numbers mean for the next step.
#pragma once

#include <string>
#include <vector>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// Returns the notes, a sentence or two each: views that repeat others, residuals that contradict the stated sigmas,
/// cameras that fit worse as a rig than alone, poorly determined parameters, an open sign of gravity.
std::vector<std::string> notes(const Result& result);

}  // namespace slom::app::calib
