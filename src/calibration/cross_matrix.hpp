// The matrix of a vector product.
#pragma once

#include <Eigen/Core>

namespace slom::calibration {

/// v x w = crossMatrix(v) * w
inline Eigen::Matrix3d crossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d M;
  M << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return M;
}

}  // namespace slom::calibration
