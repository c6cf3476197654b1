// What the motion of the rig says about an IMU, and what it leaves uncertain.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "calibration/streams/start.hpp"

namespace slom::calibration {

/// Returns the root mean squares of the motion while images were taken, in the axes of the IMU.
ImuExcitation excitationOf(const ImuStream& imu, const std::vector<RigAtImage>& images,
                           const ImuStreamResult& fitted);

/// Returns sentences on directions of the pose that are much less certain than others, on errors of axes that are
/// uncertain, and which motion would determine them. `covariance`: of left2imu.
std::vector<std::string> uncertainOf(const ImuStreamResult& fitted, const Eigen::MatrixXd& covariance);

}  // namespace slom::calibration
