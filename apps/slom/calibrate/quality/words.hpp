// What the quality of a calibration says, in words.
#pragma once

#include <string>

#include "calibrate/result.hpp"

namespace slom::app::calib {

/// `a board tilted by 40 degrees, its left edge farther away, in the upper left of the image of left, at 0.60
/// m: from 1.1 to 0.70 px`
std::string sentenceOf(const FurtherView& view, const Result& result);

}  // namespace slom::app::calib
