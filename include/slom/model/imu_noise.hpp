/// Noise of an IMU, as data sheets and calibrations state it.
#pragma once

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// Densities of white noise, and of the random walk of the biases, as data sheets and Kalibr's imu.yaml state them.
struct ImuNoise {
  double gyro = 0;        ///< gyroscope_noise_density [rad/s/sqrt(Hz)]
  double force = 0;       ///< accelerometer_noise_density [m/s^2/sqrt(Hz)]
  double gyro_walk = 0;   ///< gyroscope_random_walk [rad/s^2/sqrt(Hz)]
  double force_walk = 0;  ///< accelerometer_random_walk [m/s^3/sqrt(Hz)]
};

}  // namespace slom
