// The standard deviation of a bias's mean over time.
#pragma once

#include <cstddef>
#include <utility>

#include <slom/slom.hpp>

#include "slom/calibration/types.hpp"

namespace slom::calibration {

/// Returns the standard deviation of the mean of a bias, given at many times: from the joint covariance of 16 of them,
/// spread evenly, because a bias changes slowly. `covariances`: an Estimator or Clustered. `biases`: a container of VarID.
vec3 meanBiasDeviation(const auto& covariances, const auto& biases) {
  constexpr std::size_t few = 16;
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

/// Writes the standard deviations of both biases.
void setBiasDeviations(const auto& covariances, const auto& gyro, const auto& force, vec3& gyro_std,
                       vec3& force_std) {
  gyro_std = meanBiasDeviation(covariances, gyro);
  force_std = meanBiasDeviation(covariances, force);
}

}  // namespace slom::calibration
