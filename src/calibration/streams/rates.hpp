// Angular velocities of cameras and gyroscope over the same intervals.
#pragma once

#include <utility>
#include <vector>

#include "calibration/streams/start.hpp"

namespace slom::calibration {

constexpr double longest_pair = 0.5;  // s; images farther apart say little about the rate between them

/// The mean angular velocity between two images, in the reference camera.
struct CameraRate {
  double from = 0, to = 0;
  vec3 rate;
};

std::vector<CameraRate> cameraRates(const std::vector<RigAtImage>& images);

/// The integral of the angular velocity, for means over intervals.
class GyroIntegral {
 public:
  /// The stream must outlive this object.
  explicit GyroIntegral(const ImuStream& imu);
  /// Returns whether there are readings from one time to the other, without a gap.
  bool covers(double from, double to) const;
  vec3 mean(double from, double to) const { return vec3((at(to) - at(from)) / (to - from)); }

 private:
  vec3 at(double time) const;

  const std::vector<ImuSample>& samples_;
  std::vector<vec3> sums_;
  std::vector<std::pair<double, double>> gaps_;
};

/// Rates of both sensors in the same intervals.
struct RatePairs {
  std::vector<vec3> camera, gyro;
};

/// Returns the pairs with this offset of the clocks, where the gyroscope has readings.
RatePairs pairsAt(double offset, const std::vector<CameraRate>& rates, const GyroIntegral& gyro);

/// The rotation, or with `mirrored` the rotation and reflection, that best moves the camera's rates to the gyroscope's.
struct RatesAlignment {
  Eigen::Matrix3d R;
  vec3 bias;
  double rms = 0;
};

RatesAlignment align(const RatePairs& pairs, bool mirrored);

}  // namespace slom::calibration
