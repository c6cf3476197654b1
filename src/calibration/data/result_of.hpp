// Checks whether a result belongs to some data. Questions about both use indices of one in the other.
#pragma once

#include <string>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Returns a clause that says how the two differ: cameras, their names and corners, images, the IMU and its readings.
/// Empty if calibrate() may have made the result from these data.
std::string differenceOf(const Dataset& data, const Result& result);

}  // namespace slom::calibration
