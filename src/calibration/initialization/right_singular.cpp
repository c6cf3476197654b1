#include "calibration/initialization/right_singular.hpp"

#include <Eigen/SVD>

namespace slom::calibration {

RightSingular rightSingular(const Eigen::MatrixXd& A) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixV()};
}

}  // namespace slom::calibration
