// Specific forces compared with the accelerations of the cameras.
#pragma once

#include <string>
#include <vector>

#include "calibration/streams/start.hpp"

namespace slom::calibration {

/// Refuses forces whose axes are not those of the angular velocities, or with the sign of gravity itself: with other axes
/// they fit the motion of the cameras much better. Throws DataError [slom.calibration.bad-stream].
void requireForcesOfMotion(const ImuStream& imu, const std::vector<RigAtImage>& images,
                           const RatesStart& start);

/// Returns what to do with angular velocities of the other hand: to change their axes alone, if the forces then fit the
/// motion of the cameras as they are, otherwise those of both sensors. `mirrored`: turns rates of the camera into the
/// readings, and mirrors them.
std::string remedyOfHand(const ImuStream& imu, const std::vector<RigAtImage>& images, RatesStart start,
                         const Eigen::Matrix3d& mirrored);

}  // namespace slom::calibration
