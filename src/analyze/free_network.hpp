/// Covariances of a network whose gauge is free: the pseudo-inverse of H = J^T J.
#pragma once

#include "analyze/linearized_problem.hpp"
#include "slom/solve/block_solver.hpp"

namespace slom {

/// With N an orthonormal basis of the null space of H, and C any inverse that holds as many unknowns as it has directions,
/// the pseudo-inverse is S C S^T, S = I - N N^T.
///   source   Baarda, "S-transformations and criterion matrices", 1973
class FreeNetwork final : public InverseBlocks {
 public:
  /// Throws [slom.rank-deficient] when more than the gauge is free.
  explicit FreeNetwork(const LinearizedProblem& linearized);

  void block(int a, int b, double* out) const override;
  /// By unknown, positive for as many unknowns as there are free directions: what is added to the diagonal of H so that it is regular, and
  /// changes no residual of a solution.
  const Eigen::VectorXd& damping() const { return damping_; }
  /// Whether any direction is free.
  bool isFree() const { return N_.cols() > 0; }
  /// The part of a step, by unknown, that moves along the free directions.
  Eigen::VectorXd freePartOf(const Eigen::VectorXd& step) const { return N_ * (N_.transpose() * step); }
  /// Columns of the pseudo-inverse: those of the unknowns [first, first + count).
  Eigen::MatrixXd columns(int first, int count) const;
  /// The pseudo-inverse times B.
  Eigen::MatrixXd times(const Eigen::MatrixXd& B) const;

 private:
  Eigen::MatrixXd rowsOf(const Eigen::MatrixXd& A, int block) const;

  BlockStructure structure_;
  mutable BlockSolver solver_;  // which solves without changing its numbers
  Eigen::VectorXd damping_;
  Eigen::MatrixXd N_, CN_, NCN_;  // N, C N and N^T C N
  std::unique_ptr<InverseBlocks> damped_inverse_;
};

}  // namespace slom
