// Specific forces compared with the accelerations of the cameras.
#pragma once

#include <vector>

#include "calibration/streams/start.hpp"

namespace slom::calibration {

/// Refuses forces whose axes are not those of the angular velocities, or with the sign of gravity itself: with other axes
/// they fit the motion of the cameras much better. Throws DataError [slom.calibration.bad-stream].
void requireForcesOfMotion(const ImuStream& imu, const std::vector<RigAtImage>& images,
                           const RatesStart& start);

}  // namespace slom::calibration
