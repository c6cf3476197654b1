// The matrix of a vector product.
#pragma once

#include <Eigen/Core>

namespace slom::calibration {

/// Returns the matrix M of the vector product: v x w = M w.
inline Eigen::Matrix3d crossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d M;
  M << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return M;
}

}  // namespace slom::calibration
