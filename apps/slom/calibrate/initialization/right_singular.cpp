#include "calibrate/initialization/right_singular.hpp"

#include <Eigen/SVD>

namespace slom::app::calib {

RightSingular rightSingular(const Eigen::MatrixXd& A) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixV()};
}

}  // namespace slom::app::calib
