/// Decompositions of dense matrices by Eigen, compiled once. Each instantiation costs a compiler several seconds.
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace slom {

using PivotedQR = Eigen::ColPivHouseholderQR<Eigen::MatrixXd>;
using SVD = Eigen::JacobiSVD<Eigen::MatrixXd>;
using SymmetricEigen = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;

/// Returns the singular value decomposition; `options` as Eigen's: Eigen::ComputeThinU, ...
SVD svdOf(const Eigen::MatrixXd& A, unsigned options);

/// Returns eigenvalues, ascending, and eigenvectors of a symmetric matrix. Only the lower triangle is read.
SymmetricEigen eigenOf(const Eigen::MatrixXd& A, int options = Eigen::ComputeEigenvectors);

/// Returns orthonormal columns with the span of A. The columns of A must be independent, and not more than its rows.
Eigen::MatrixXd orthonormalBasis(const Eigen::MatrixXd& A);

/// Computes R of A = Q R in the upper triangle of A. Entries below it are not zero.
void triangularize(Eigen::Ref<Eigen::MatrixXd> A);

PivotedQR pivotedQrOf(const Eigen::MatrixXd& A);
/// Returns the first `count` columns of Q.
Eigen::MatrixXd columnsOfQ(const PivotedQR& qr, Eigen::Index count);
/// Returns the X that minimises |A X - B|.
Eigen::MatrixXd leastSquares(const PivotedQR& qr, const Eigen::MatrixXd& B);

}  // namespace slom
