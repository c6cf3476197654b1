// The singular value decomposition of a matrix of any size, without U, for the start values. Compiled once, because
// its code is long.
#pragma once

#include <Eigen/Core>

namespace slom::calibration {

/// A = U S V^T, without U.
struct RightSingular {
  Eigen::VectorXd values;   ///< descending
  Eigen::MatrixXd vectors;  ///< V, square; in its last column |A v| is least
};
RightSingular rightSingular(const Eigen::MatrixXd& A);

}  // namespace slom::calibration
