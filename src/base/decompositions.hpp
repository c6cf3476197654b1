/// Decompositions of dense matrices by Eigen, compiled once: each costs a compiler several seconds wherever it is computed.
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace slom {

using PivotedQR = Eigen::ColPivHouseholderQR<Eigen::MatrixXd>;
using SVD = Eigen::JacobiSVD<Eigen::MatrixXd>;
using SymmetricEigen = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;

/// `options` as Eigen's: Eigen::ComputeThinU, ...
SVD svdOf(const Eigen::MatrixXd& A, unsigned options);

/// Eigenvalues, ascending, and eigenvectors of a symmetric matrix, whose lower triangle is read.
SymmetricEigen eigenOf(const Eigen::MatrixXd& A, int options = Eigen::ComputeEigenvectors);

/// Orthonormal columns that span those of A, which are independent and not more than its rows.
Eigen::MatrixXd orthonormalBasis(const Eigen::MatrixXd& A);

/// Leaves R of A = Q R in the upper triangle of A; what is below it is not zero.
void triangularize(Eigen::Ref<Eigen::MatrixXd> A);

PivotedQR pivotedQrOf(const Eigen::MatrixXd& A);
/// The first columns of Q.
Eigen::MatrixXd columnsOfQ(const PivotedQR& qr, Eigen::Index count);
/// X of least ||A X - B||.
Eigen::MatrixXd leastSquares(const PivotedQR& qr, const Eigen::MatrixXd& B);

}  // namespace slom
