// An IMU with errors of its axes.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include <mtk/testing/random.hpp>
#include <slom/calibration.hpp>

namespace slom::calibration::testing {

/// Draws scales, misalignments and sensitivities as of a cheap sensor.
inline ImuModel<> randomErrors(mtk::testing::Random& random) {
  ImuModel<> model;
  for (double& x : model.force_axes) x = random.uniform(-0.02, 0.02);
  for (double& x : model.gyro_axes) x = random.uniform(-0.02, 0.02);
  for (double& x : model.gyro_by_force) x = random.uniform(-1e-3, 1e-3);
  return model;
}

/// Returns the errors in the order of ImuAxesResult::std.
inline std::vector<double> numbersOf(const ImuModel<>& model) {
  std::vector<double> all;
  const auto append = [&](const auto& more) { all.insert(all.end(), more.begin(), more.end()); };
  append(model.force_axes), append(model.gyro_axes), append(model.gyro_by_force), append(model.force_places);
  return all;
}

/// Returns readings of an IMU with these errors of its axes, which an ideal one would read.
inline std::vector<ImuSample> withErrors(const std::vector<ImuSample>& ideal, const ImuModel<>& model) {
  const auto& a = model.force_axes;
  const auto square = [](const auto& m) {
    return (Eigen::Matrix3d() << m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8]).finished();
  };
  const Eigen::Matrix3d M =
      (Eigen::Matrix3d() << 1 + a[0], 0, 0, a[1], 1 + a[2], 0, a[3], a[4], 1 + a[5]).finished();
  const Eigen::Matrix3d G = Eigen::Matrix3d::Identity() + square(model.gyro_axes),
                        A = square(model.gyro_by_force);
  std::vector<ImuSample> readings = ideal;
  for (std::size_t i = 1; i + 1 < ideal.size(); ++i) {
    const Eigen::Vector3d w = ideal[i].gyro, slope = (ideal[i + 1].gyro - ideal[i - 1].gyro) /
                                                     (ideal[i + 1].time - ideal[i - 1].time);
    Eigen::Vector3d f = ideal[i].force;
    for (int k = 1; k < 3; ++k) {
      const Eigen::Vector3d r = model.force_places.segment<3>(3 * k - 3);
      f[k] += (slope.cross(r) + w.cross(w.cross(r)))[k];
    }
    readings[i].force = vec3(M * f);
    readings[i].gyro = vec3(G * w + A * ideal[i].force);
  }
  return readings;
}

}  // namespace slom::calibration::testing
