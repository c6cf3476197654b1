/// BlockSolver, the default solver: block-sparse normal equations, solved by a multifrontal block Cholesky
/// decomposition or by conjugate gradients. Many small blocks (points that cameras see) are eliminated first.
#pragma once

#include <memory>

#include "slom/solve/forwarding_solver.hpp"

namespace slom {

/// Options of a BlockSolver. It chooses automatic ones by predicted cost.
struct BlockSolverOptions {
  enum class Method {
    automatic,
    cholesky,             ///< exact; detects a loss of rank
    conjugate_gradients,  ///< inexact steps; needs little memory; does not detect a loss of rank
  };
  enum class Elimination {
    automatic,
    none,  ///< no Schur complement
  };
  enum class Preconditioner {
    schur_jacobi,  ///< the diagonal blocks of the reduced system
    block_jacobi,  ///< the diagonal blocks of the remaining blocks, as if nothing had been eliminated
    /// Some terms of the Neumann series of the reduced system, if the remaining blocks do not meet each other directly;
    /// otherwise schur_jacobi.
    power_series,
  };

  Method method = Method::automatic;
  Elimination elimination = Elimination::automatic;
  Preconditioner preconditioner = Preconditioner::schur_jacobi;
  /// Tolerance of conjugate gradients. They end when the residual is min(forcing, sqrt(|g| / largest |g| so far)) times
  /// the first one, in the norms of the preconditioner and of the diagonal. So steps are rough at first, and
  /// convergence near the minimum is superlinear.
  ///   source   Nocedal and Wright, "Numerical Optimization", 2006, section 7.1
  double forcing = 0.1;
  int max_iterations = 500;  ///< maximum number of conjugate gradient iterations in each step
};

/// Solves (J^T J + damping) d = -J^T r. The order of elimination and the layout of the factor come from the graph of
/// variables, once for each structure. Dense arithmetic is chosen for the processor at run time.
class BlockSolver final : public ForwardingSolver {
 public:
  /// Checks the options. Throws [slom.bad-option].
  explicit BlockSolver(const BlockSolverOptions& options = {});
  /// Solves (H + damping) X = B. `damping`: an entry >= 0 for each unknown.
  SolveStatus solveDamped(const Eigen::VectorXd& damping, const Eigen::MatrixXd& B, Eigen::MatrixXd& X);
  /// Computes blocks of (H + damping)^-1, for exact methods.
  SolveStatus invertDamped(const Eigen::VectorXd& damping, std::unique_ptr<InverseBlocks>& blocks);
  /// Returns the additions and multiplications of one factorisation; 0 with conjugate gradients.
  double flops() const;
  std::unique_ptr<LinearSolver> makeAnother() const override;

 private:
  struct Implementation;
};

}  // namespace slom
