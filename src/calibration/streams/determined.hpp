// Whether the data determine the pose of an IMU.
#pragma once

#include <functional>
#include <string>

#include <Eigen/Core>

#include "slom/calibration/imu_stream.hpp"

namespace slom::calibration {

/// Returns a sentence on the direction in which the pose of an IMU is hardly determined, or nothing. `covariance`: of
/// left2imu.
std::string openDirectionOf(const std::string& name, const Eigen::MatrixXd& covariance);

/// Returns a sentence if the motion hardly determines the time offset or the line delay of a camera, or nothing.
std::string openTimingOf(const CameraStreamResult& camera);

/// Sets the standard deviations of the pose of an IMU. `covariance`: of left2imu.
void setPoseDeviations(const Eigen::MatrixXd& covariance, ImuStreamResult& imu);
/// Sets the clustered ones likewise.
void setClusteredDeviations(const Eigen::MatrixXd& covariance, ImuStreamResult& imu);

/// Begins a result with how a fit ended.
StreamResult endOf(const Summary& summary);
/// Adds standard deviations by `stated` and, if the data determine all values, by `clustered`. If they do not, the result
/// says why, and has no standard deviations.
void addDeviations(const std::function<void()>& stated, const std::function<void()>& clustered,
                   StreamResult& result);

}  // namespace slom::calibration
