/// The slow, accurate reference: keeps J whole and solves by a column-pivoted QR decomposition, so that the condition
/// number is not squared. For small or ill-conditioned problems, and as the oracle of the other solvers.
#pragma once

#include "slom/solve/forwarding_solver.hpp"

namespace slom {

/// The solver.
class DenseQR final : public ForwardingSolver {
 public:
  DenseQR();

  /// The whitened Jacobian (residuals x unknowns) and residual of the last linearisation.
  const Eigen::MatrixXd& jacobian() const;
  /// Whitened, one entry for each row of the Jacobian.
  const Eigen::VectorXd& residual() const;
  std::unique_ptr<LinearSolver> makeAnother() const override;

 private:
  struct Implementation;
};

}  // namespace slom
