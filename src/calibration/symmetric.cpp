#include "calibration/symmetric.hpp"

namespace slom::calibration {

SymmetricEigen eigenOf(const Eigen::MatrixXd& A) {
  SymmetricEigen eigen(A.rows());
  if (A.rows() > 0)
    eigen.compute(A);  // which reads the first entry
  else
    eigen.computeFromTridiagonal(Eigen::VectorXd(),
                                 Eigen::VectorXd());  // no values, but allowed to be asked for
  return eigen;
}

Eigen::MatrixXd scaledOnBothSides(const Eigen::MatrixXd& A, const Eigen::VectorXd& scale) {
  return scale.asDiagonal() * A * scale.asDiagonal();
}

Eigen::MatrixXd composed(const Eigen::MatrixXd& U, const Eigen::VectorXd& values) {
  return U * values.asDiagonal() * U.transpose();
}

}  // namespace slom::calibration
