// Readings of an IMU at their own times, as measurements of the spline of the reference camera.
//   pose, bias   segments: of the reference camera in the world, by the clock of the cameras; of the sensor's bias, by that
//                of the IMU
//   left2imu     points of the reference camera in the frame of the IMU
//   offset       t_imu - t_camera [s]
//   up           direction against gravity, in the world
//   board_scale  true length on the board / length of the poses; the arm from the reference camera to the IMU is true
//   time         of the reading, in the clock of the IMU [s]
// Other variables are those of ImuModel, which has the formulas.
#pragma once

#include <type_traits>

#include "slom/calibration/types.hpp"
#include "slom/measurements/imu_model.hpp"

namespace slom::calibration {

/// An angular velocity.
struct GyroOnSpline {
  auto operator()(const auto& pose, const auto& bias, const auto& left2imu, const auto& offset,
                  double time) const {
    return left2imu.orient * pose.angularVelocityAt(time - offset) + bias.at(time);
  }
};

/// Angular velocity, its derivative by time, and specific force, without errors, in the axes of the IMU.
template <class V>
struct ImuMotionAt {
  V turn, turn_slope, force;
};

/// Returns the motion at a time; the force is the acceleration of the IMU minus gravity.
auto imuMotionAt(const auto& pose, const auto& left2imu, const auto& t, const auto& up, double gravity,
                 const auto& board_scale) {
  const auto cross = [](const auto& a, const auto& b) { return trajectory::detail::cross(a, b); };
  const auto motion = pose.angularMotionAt(t);
  const auto arm = left2imu.inverse().pos;  // of the IMU, in the axes of the reference camera
  const auto& w = motion.velocity;
  const auto force =
      pose.orientationAt(t).inverse() * (pose.accelerationAt(t) * board_scale + up.vector() * gravity) +
      cross(motion.acceleration, arm) + cross(w, cross(w, arm));
  using V = std::decay_t<decltype(left2imu.orient * force)>;
  return ImuMotionAt<V>{left2imu.orient * w, left2imu.orient * motion.acceleration, left2imu.orient * force};
}

/// A specific force. `gravity`: magnitude [m/s^2].
struct ForceOnSpline {
  double gravity;

  auto operator()(const auto& pose, const auto& bias, const auto& left2imu, const auto& offset,
                  const auto& up, const auto& board_scale, double time) const {
    return imuMotionAt(pose, left2imu, time - offset, up, gravity, board_scale).force + bias.at(time);
  }
};

/// An angular velocity with errors of the gyroscope's axes: G w + A f + bias.
struct GyroWithAxesOnSpline {
  double gravity;

  auto operator()(const auto& pose, const auto& bias, const auto& left2imu, const auto& offset,
                  const auto& up, const auto& board_scale, const auto& gyro_axes, const auto& gyro_by_force,
                  double time) const {
    const auto motion = imuMotionAt(pose, left2imu, time - offset, up, gravity, board_scale);
    auto reading = motion.turn;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j)
        reading[i] += gyro_axes[3 * i + j] * motion.turn[j] + gyro_by_force[3 * i + j] * motion.force[j];
    }
    return reading + bias.at(time);
  }
};

/// A specific force with errors of the accelerometer's axes: M (f + s) + bias.
struct ForceWithAxesOnSpline {
  double gravity;

  auto operator()(const auto& pose, const auto& bias, const auto& left2imu, const auto& offset,
                  const auto& up, const auto& board_scale, const auto& force_axes, const auto& force_places,
                  double time) const {
    const auto motion = imuMotionAt(pose, left2imu, time - offset, up, gravity, board_scale);
    auto felt = motion.force;
    const auto& a = force_axes;
    for (int k = 1; k < 3; ++k) {
      auto place = felt;
      for (int i = 0; i < 3; ++i) place[i] = force_places[3 * k - 3 + i];
      felt[k] += slom::detail::cross(motion.turn_slope, place, k) +
                 slom::detail::cross(motion.turn, slom::detail::cross(motion.turn, place), k);
    }
    auto reading = felt;
    reading[0] = (1 + a[0]) * felt[0];
    reading[1] = a[1] * felt[0] + (1 + a[2]) * felt[1];
    reading[2] = a[3] * felt[0] + a[4] * felt[1] + (1 + a[5]) * felt[2];
    return reading + bias.at(time);
  }
};

}  // namespace slom::calibration
