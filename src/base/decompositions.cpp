#include "base/decompositions.hpp"

namespace slom {

using Eigen::MatrixXd;

SVD svdOf(const MatrixXd& A, unsigned options) { return SVD(A, options); }

SymmetricEigen eigenOf(const MatrixXd& A, int options) {
  SymmetricEigen eigen(A.rows());
  if (A.rows() > 0)
    eigen.compute(A, options);  // which reads the first entry
  else
    eigen.computeFromTridiagonal(Eigen::VectorXd(), Eigen::VectorXd(), options);
  return eigen;
}

MatrixXd orthonormalBasis(const MatrixXd& A) {
  const Eigen::HouseholderQR<MatrixXd> qr(A);
  return qr.householderQ() * MatrixXd::Identity(A.rows(), A.cols());
}

void triangularize(Eigen::Ref<MatrixXd> A) { const Eigen::HouseholderQR<Eigen::Ref<MatrixXd>> in_place(A); }

PivotedQR pivotedQrOf(const MatrixXd& A) { return PivotedQR(A); }

MatrixXd columnsOfQ(const PivotedQR& qr, Eigen::Index count) {
  return qr.householderQ() * MatrixXd::Identity(qr.rows(), count);
}

MatrixXd leastSquares(const PivotedQR& qr, const MatrixXd& B) { return qr.solve(B); }

}  // namespace slom
