/// The default solver: block-sparse normal equations, solved by a multifrontal block Cholesky decomposition or by
/// conjugate gradients, with many small blocks (points that cameras see) eliminated first.
#pragma once

#include <memory>

#include "slom/solve/forwarding_solver.hpp"

namespace slom {

/// What a BlockSolver does not choose by itself, by predicted cost.
struct BlockSolverOptions {
  enum class Method {
    automatic,
    cholesky,             ///< exact, and finds out where the rank runs out
    conjugate_gradients,  ///< inexact steps; needs little memory; does not notice a loss of rank
  };
  enum class Elimination {
    automatic,
    none,  ///< no Schur complement
  };
  enum class Preconditioner {
    schur_jacobi,  ///< the diagonal blocks of the reduced system
    block_jacobi,  ///< those of the blocks that are left, as if nothing had been eliminated
    power_series,  ///< some terms of the Neumann series of the reduced system; where the blocks that are left do not meet
                   ///< each other directly, otherwise schur_jacobi
  };

  Method method = Method::automatic;
  Elimination elimination = Elimination::automatic;
  Preconditioner preconditioner = Preconditioner::schur_jacobi;
  /// Conjugate gradients end when the residual is min(forcing, sqrt(|g| / largest |g| so far)) of the first one, in the
  /// norms of the preconditioner and of the diagonal: roughly at first, superlinearly near the minimum.
  ///   source   Nocedal and Wright, "Numerical Optimization", 2006, section 7.1
  double forcing = 0.1;
  int max_iterations = 500;  ///< limit of conjugate gradient iterations in each step
};

/// Solves (J^T J + damping) d = -J^T r. The order of elimination and the layout of the factor are found on the graph of
/// variables, once for each structure. Dense arithmetic is chosen for the processor at run time.
class BlockSolver final : public ForwardingSolver {
 public:
  /// Throws [slom.bad-option].
  explicit BlockSolver(const BlockSolverOptions& options = {});
  /// Solves (H + damping) X = B. `damping`: an entry >= 0 for each unknown.
  SolveStatus solveDamped(const Eigen::VectorXd& damping, const Eigen::MatrixXd& B, Eigen::MatrixXd& X);
  /// Blocks of (H + damping)^-1, for exact methods.
  SolveStatus invertDamped(const Eigen::VectorXd& damping, std::unique_ptr<InverseBlocks>& blocks);
  /// Additions and multiplications of one factorisation; 0 with conjugate gradients.
  double flops() const;
  std::unique_ptr<LinearSolver> makeAnother() const override;

 private:
  struct Implementation;
};

}  // namespace slom
