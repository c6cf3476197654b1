// The mean of a bias over time, and its standard deviation.
#pragma once

#include <cstddef>
#include <utility>

#include <slom/slom.hpp>

#include "slom/calibration/imu_stream.hpp"

namespace slom::calibration {

/// Returns the mean of a bias, given at many times. `biases`: a container of VarID.
vec3 meanBias(const auto& biases) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& id : biases) sum += *id / double(biases.size());
  return vec3(sum);
}

/// Returns the standard deviation of the mean of a bias, given at many times: from the joint covariance of a few of them,
/// spread evenly, because a bias changes slowly. `covariances`: an Estimator or Clustered. `biases`: a container of VarID.
template <std::size_t few>
vec3 meanBiasDeviation(const auto& covariances, const auto& biases) {
  if (biases.size() < few) return vec3(covariances.standardDeviation(biases[biases.size() / 2]));
  const auto at = [&](std::size_t i) -> const VarID<vec3>& {
    return biases[(2 * i + 1) * biases.size() / (2 * few)];
  };
  const Eigen::MatrixXd joint = [&]<std::size_t... I>(std::index_sequence<I...>) {
    return covariances.jointCovariance(at(I)...);
  }(std::make_index_sequence<few>());
  vec3 variance(0., 0., 0.);
  for (Eigen::Index row = 0; row < joint.rows(); ++row) {
    for (Eigen::Index column = row % 3; column < joint.cols(); column += 3)
      variance[int(row % 3)] += joint(row, column) / double(few * few);
  }
  return vec3(variance.cwiseSqrt());
}

/// Returns the clustered standard deviation of that mean: as many times the stated one, `stated`, as for the mean of 4 of
/// them, because each clustered covariance takes long.
vec3 clusteredBiasDeviation(const Estimator& est, const Clustered& clustered, const auto& biases,
                            const vec3& stated) {
  const vec3 of_few = meanBiasDeviation<4>(est, biases);
  return vec3(meanBiasDeviation<4>(clustered, biases).cwiseQuotient(of_few).cwiseProduct(stated));
}

/// Writes the stated standard deviations of both biases.
void setBiasDeviations(const Estimator& est, const auto& gyro, const auto& force, ImuStreamResult& imu) {
  imu.gyro_bias_std = meanBiasDeviation<16>(est, gyro);
  imu.force_bias_std = meanBiasDeviation<16>(est, force);
}

/// Writes the clustered ones, after the stated ones.
void setBiasDeviations(const Estimator& est, const Clustered& clustered, const auto& gyro, const auto& force,
                       ImuStreamResult& imu) {
  imu.gyro_bias_clustered = clusteredBiasDeviation(est, clustered, gyro, imu.gyro_bias_std);
  imu.force_bias_clustered = clusteredBiasDeviation(est, clustered, force, imu.force_bias_std);
}

}  // namespace slom::calibration
