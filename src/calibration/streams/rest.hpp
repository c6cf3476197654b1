// The noise of an IMU while the rig rests.
#pragma once

#include "slom/calibration/imu_stream.hpp"

namespace slom::calibration {

/// Finds the longest rest of the recording and sets ImuStreamResult::rest_from, rest_to and at_rest.
void addRest(const ImuStream& imu, ImuStreamResult& result);

}  // namespace slom::calibration
