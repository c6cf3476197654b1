/// Operations on dense symmetric matrices, compiled once, because Eigen's decompositions add seconds to each file
/// that uses them. The library slom has similar ones in base/decompositions.hpp but does not export them, and this is
/// a library of its own.
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

namespace slom::calibration {

using SymmetricEigen = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;

/// Returns eigenvalues, ascending, and eigenvectors of a symmetric matrix. Reads its lower triangle.
SymmetricEigen eigenOf(const Eigen::MatrixXd& A);

/// Returns diag(scale) A diag(scale).
Eigen::MatrixXd scaledOnBothSides(const Eigen::MatrixXd& A, const Eigen::VectorXd& scale);

/// Returns U diag(values) U^T.
Eigen::MatrixXd composed(const Eigen::MatrixXd& U, const Eigen::VectorXd& values);

}  // namespace slom::calibration
