// Start values of the IMU from pairs of tilts: "up" as the cameras see it and the accelerometer's reading.
//   model   reading = left2imu * (gravity * up_in_left) + acc_bias + noise       [m/s^2]
// `gravity` is positive if the sensor reports the reaction to gravity (specific force, up) on a board with z up. It
// is negative if the sensor reports gravity itself, or if the board lies with z down.
#pragma once

#include <vector>

#include "calibration/initialization/rig.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

struct TiltPair {
  vec3 up_in_left;  ///< world z axis in the left camera, |.| = 1
  vec3 acc;         ///< [m/s^2]
};

std::vector<TiltPair> tiltPairs(const ImuData& imu, const std::map<int, SE3>& left2world);

struct ImuStart {
  SO3 left2imu;
  vec3 acc_bias;       ///< [m/s^2], zero unless fixed to another value
  double gravity = 0;  ///< with sign [m/s^2]
  /// Sum of squared misfits with the other sign, minus that with the chosen sign, in units of sigma_acc^2. Below 9
  /// the data leave the sign open (tilts about one axis only).
  double sign_evidence = 0;
};

/// Computes the rotation by Wahba's problem on the directions (Kabsch's algorithm), for both signs of gravity. The
/// magnitude is the mean of the readings' magnitudes. Fixed parameters keep their values.
ImuStart startImu(const std::vector<TiltPair>& pairs, const Fixed& fixed, double sigma_acc);

/// Returns how well the pairs determine the IMU, with known poses and without the parameters in `fixed`; infinite for
/// undetermined parameters.
ImuPrecision imuPrecision(const std::vector<TiltPair>& pairs, const ImuStart& at, const Fixed& fixed,
                          double sigma_acc);

/// Returns whether an estimate is meaningful: rotation to a radian, the others to 10 m/s^2.
bool isDetermined(const ImuPrecision& precision);

/// Returns the root mean square angle between the directions of up and their mean [rad].
double tiltSpread(const std::vector<TiltPair>& pairs);

/// Throws DataError with a remedy if the pairs do not determine all parameters that are not fixed.
void requireImuDetermined(const ImuData& imu, const std::vector<TiltPair>& pairs, const ImuStart& at,
                          const Fixed& fixed, double sigma_acc);

}  // namespace slom::calibration
