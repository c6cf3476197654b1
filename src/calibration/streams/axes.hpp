// The errors of an IMU's axes as variables of a fit.
#pragma once

#include <string>
#include <vector>

#include <slom/slom.hpp>

#include "slom/calibration/imu_stream.hpp"

namespace slom::calibration {

/// The variables, as ImuModel has them.
struct AxesVariables {
  ImuAxes estimated = ImuAxes::calibrated;  ///< if calibrated, there are no variables
  VarID<mtk::vect<6>> force_axes{}, force_places{};
  VarID<mtk::vect<9>> gyro_axes{}, gyro_by_force{};

  bool exist() const { return estimated != ImuAxes::calibrated; }
  /// Inserts the variables that `axes` needs. `imu`: its name.
  void insert(Estimator& est, ImuAxes axes, const ImuModel<>& start, const std::string& imu) {
    estimated = axes;
    if (!exist()) return;
    force_axes = est.insertRV(start.force_axes, true, imu + ".acc_axes");
    gyro_axes = est.insertRV(start.gyro_axes, true, imu + ".gyro_axes");
    gyro_by_force = est.insertRV(start.gyro_by_force, true, imu + ".gyro_by_acc");
    force_places = est.insertRV(start.force_places, axes == ImuAxes::scale_misalignment_size_effect,
                                imu + ".acc_places");
  }
  /// Returns the model with these biases.
  ImuModel<> modelWith(const vec3& gyro_bias, const vec3& force_bias) const {
    ImuModel<> model{gyro_bias, force_bias};
    if (!exist()) return model;
    model.force_axes = *force_axes;
    model.gyro_axes = *gyro_axes;
    model.gyro_by_force = *gyro_by_force;
    model.force_places = *force_places;
    return model;
  }
  /// Calls f with the variables, if there are any, and returns what it returns. There are two kinds of measurements only,
  /// because each takes long to compile.
  template <class F>
  auto with(const F& f) const {
    if (!exist()) return f();
    return f(force_axes, gyro_axes, gyro_by_force, force_places);
  }
  /// Returns what f returns for the variables that are estimated, one after another, in the order of ImuAxesResult::std.
  template <class F>
  std::vector<double> ofEach(const F& f) const {
    std::vector<double> all;
    const auto append = [&](const Eigen::VectorXd& one) { all.insert(all.end(), one.begin(), one.end()); };
    if (!exist()) return all;
    append(f(force_axes)), append(f(gyro_axes)), append(f(gyro_by_force));
    if (estimated == ImuAxes::scale_misalignment_size_effect) append(f(force_places));
    return all;
  }
};

}  // namespace slom::calibration
