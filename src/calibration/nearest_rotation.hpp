// The rotation nearest to a matrix.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace slom::calibration {

using Svd3 = Eigen::JacobiSVD<Eigen::Matrix3d>;

/// Returns the decomposition with both matrices of vectors.
inline Svd3 svdOf(const Eigen::Matrix3d& M) { return Svd3(M, Eigen::ComputeFullU | Eigen::ComputeFullV); }

/// Returns the rotation R with the largest trace(R^T M), U V^T with determinant 1; with `mirrored`, the rotation and
/// reflection, with determinant -1. Source: Kabsch, 1976.
inline Eigen::Matrix3d nearestRotation(const Svd3& svd, bool mirrored = false) {
  const bool is_mirrored = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0;
  const Eigen::Vector3d signs(1, 1, is_mirrored == mirrored ? 1 : -1);
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}
inline Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& M, bool mirrored = false) {
  return nearestRotation(svdOf(M), mirrored);
}

}  // namespace slom::calibration
