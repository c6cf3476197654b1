/// What is done to dense symmetric matrices, compiled once: Eigen's decompositions cost a compiler seconds wherever they are used.
/// The library slom has the like in base/decompositions.hpp, but does not export it, and this is a library of its own.
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

namespace slom::calibration {

using SymmetricEigen = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;

/// Eigenvalues, ascending, and eigenvectors of a symmetric matrix, whose lower triangle is read.
SymmetricEigen eigenOf(const Eigen::MatrixXd& A);

/// diag(scale) A diag(scale)
Eigen::MatrixXd scaledOnBothSides(const Eigen::MatrixXd& A, const Eigen::VectorXd& scale);

/// U diag(values) U^T
Eigen::MatrixXd composed(const Eigen::MatrixXd& U, const Eigen::VectorXd& values);

}  // namespace slom::calibration
