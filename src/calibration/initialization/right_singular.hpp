// The singular value decomposition of a matrix of any size, as far as the start values need it. Compiled once: its code is
// long.
#pragma once

#include <Eigen/Core>

namespace slom::calibration {

/// A = U S V^T, without U.
struct RightSingular {
  Eigen::VectorXd values;   ///< falling
  Eigen::MatrixXd vectors;  ///< V, square: the last column is where |A v| is least
};
RightSingular rightSingular(const Eigen::MatrixXd& A);

}  // namespace slom::calibration
