#include "calibration/rotation_vector.hpp"

#include <cmath>

#include "calibration/cross_matrix.hpp"

namespace slom::calibration {

Eigen::Matrix3d rotationVectorJacobian(const SO3& R) {
  const vec3 v = SO3::log(R);
  const double angle = v.norm();
  const Eigen::Matrix3d cross = crossMatrix(v);
  // (1 - (t/2) cot(t/2)) / t^2 = 1/12 + t^2/720 + ...
  const double factor = angle < 1e-3 ? 1.0 / 12 : (1 - angle / 2 / std::tan(angle / 2)) / (angle * angle);
  return Eigen::Matrix3d::Identity() + 0.5 * cross + factor * cross * cross;
}

vec3 rotationVectorStd(const SO3& R, const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix3d J = rotationVectorJacobian(R);
  return vec3((J * covariance * J.transpose()).diagonal().cwiseSqrt());
}

}  // namespace slom::calibration
