// The fits that are compared. All estimate the pose of the camera on the body, the offset of the clocks, constant biases
// and the direction of gravity, besides the motion.
#pragma once

#include <functional>
#include <optional>

#include "data.hpp"

namespace slom::bench {

/// What a fit says.
struct Fit {
  bool converged = false;
  int unknowns = 0, iterations = 0;
  double seconds = 0, chi2_per_dof = 0;
  double offset = 0, offset_sigma = 0;
  Pose body_T_camera;
  Eigen::MatrixXd covariance;               ///< of body_T_camera; empty: not estimated
  std::function<Pose(double time)> poseAt;  ///< world_T_body
};

/// States at the images, joined by readings that are integrated anew for each offset and each bias.
Fit byPreintegration(const Recording& recording);
/// A PoseSpline with uniform knots.
Fit bySpline(const Recording& recording, int order, double spacing);
/// A PoseProcess with white noise on jerk. Density: position [m^2/s^5], orientation [rad^2/s^5].
Fit byProcess(const Recording& recording, double spacing, double position_density,
              double orientation_density);

/// Two cameras with clocks of their own and a gyroscope: no two of them measure at the same time.
struct Asynchronous {
  std::vector<Sighting> first, second;  ///< poses of the body, and of the second camera
  std::vector<ImuSample> readings;      ///< angular velocities alone
  double position_sigma, angle_sigma, gyro_sigma;
};
/// Simulates 17 and 23 poses and 100 angular velocities each second.
Asynchronous simulateAsynchronous(const Truth& truth, double duration, std::uint64_t seed);
/// Estimates body_T_camera and the offset of the second camera, and the bias of the gyroscope, whose clock is that of
/// the second camera.
Fit bySpline(const Asynchronous& recording, int order, double spacing);
/// Does so with a process. `on_jerk`: white noise on jerk in place of acceleration.
Fit byProcess(const Asynchronous& recording, bool on_jerk, double spacing, double position_density,
              double orientation_density);

}  // namespace slom::bench
