/// Covariances of a network whose gauge is free: the pseudo-inverse of H = J^T J.
#pragma once

#include "analyze/linearized_problem.hpp"
#include "slom/solve/block_solver.hpp"

namespace slom {

/// The pseudo-inverse S C S^T with S = I - N N^T. N is an orthonormal basis of the null space of H. C is any inverse
/// that holds fixed as many unknowns as N has directions.
///   source   Baarda, "S-transformations and criterion matrices", 1973
class FreeNetwork final : public InverseBlocks {
 public:
  /// Throws [slom.rank-deficient] if more than the gauge is free.
  explicit FreeNetwork(const LinearizedProblem& linearized);

  void block(int a, int b, double* out) const override;
  /// Returns the damping by unknown, positive for as many unknowns as there are free directions. Added to the diagonal
  /// of H, it makes H regular and changes no residual of a solution.
  const Eigen::VectorXd& damping() const { return damping_; }
  /// Returns whether any direction is free.
  bool isFree() const { return N_.cols() > 0; }
  /// Returns the part of a step, by unknown, along the free directions.
  Eigen::VectorXd freePartOf(const Eigen::VectorXd& step) const { return N_ * (N_.transpose() * step); }
  /// Returns columns of the pseudo-inverse: those of the unknowns [first, first + count).
  Eigen::MatrixXd columns(int first, int count) const;
  /// Returns the pseudo-inverse times B.
  Eigen::MatrixXd times(const Eigen::MatrixXd& B) const;

 private:
  Eigen::MatrixXd rowsOf(const Eigen::MatrixXd& A, int block) const;

  BlockStructure structure_;
  mutable BlockSolver solver_;  // mutable: solving does not change its factor
  Eigen::VectorXd damping_;
  Eigen::MatrixXd N_, CN_, NCN_;  // N, C N and N^T C N
  std::unique_ptr<InverseBlocks> damped_inverse_;
};

}  // namespace slom
