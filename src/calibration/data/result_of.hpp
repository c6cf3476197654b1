// Whether a result is that of some data: what is asked of both together takes indices of one into the other.
#pragma once

#include <string>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// A clause that says in what the two differ: cameras, their names and corners, images, the IMU and its readings. Empty where the
/// result may be that of calibrate() with these data.
std::string differenceOf(const Dataset& data, const Result& result);

}  // namespace slom::calibration
