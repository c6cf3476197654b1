#include "analyze/clustered/elimination.hpp"

#include <cmath>

#include <Eigen/Cholesky>

#include "base/decompositions.hpp"

namespace slom {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLeastPivot = 1e-11;  // relative

/// Returns X = A^+ B for a positive semidefinite A.
MatrixXd solveSemidefinite(const MatrixXd& A, const MatrixXd& B) {
  const VectorXd scale =
      A.diagonal().unaryExpr([](double a) { return a > 0 ? 1 / std::sqrt(a) : 0.0; }).eval();
  MatrixXd scaled = scale.asDiagonal() * A * scale.asDiagonal();
  for (Index i = 0; i < scale.size(); ++i) {
    if (scale[i] == 0) scaled(i, i) = 1;
  }
  const MatrixXd right = scale.asDiagonal() * B;
  const Eigen::LLT<MatrixXd> cholesky(scaled);
  if (cholesky.info() == Eigen::Success &&
      cholesky.matrixLLT().diagonal().cwiseAbs2().minCoeff() > kLeastPivot)
    return scale.asDiagonal() * cholesky.solve(right);
  const SymmetricEigen eigen = eigenOf(scaled);
  const VectorXd inverse =
      eigen.eigenvalues().unaryExpr([](double e) { return e > kLeastPivot ? 1 / e : 0.0; }).eval();
  return scale.asDiagonal() *
         (eigen.eigenvectors() * (inverse.asDiagonal() * (eigen.eigenvectors().transpose() * right)));
}

}  // namespace

void eliminate(const MatrixXd& App, const MatrixXd& Aps_bp, MatrixXd& A, VectorXd& b) {
  if (App.rows() == 0) return;
  const Index shared = A.cols();
  const MatrixXd X = solveSemidefinite(App, Aps_bp);
  A.noalias() -= Aps_bp.leftCols(shared).transpose() * X.leftCols(shared);
  b.noalias() -= Aps_bp.leftCols(shared).transpose() * X.col(shared);
}

}  // namespace slom
