/// DenseQR: the slow and accurate reference. It keeps J as a dense matrix and solves by a column-pivoted QR
/// decomposition, so the condition number is not squared. For small or ill-conditioned problems, and to test other
/// solvers against.
#pragma once

#include "slom/solve/forwarding_solver.hpp"

namespace slom {

/// The solver.
class DenseQR final : public ForwardingSolver {
 public:
  DenseQR();

  /// Returns the whitened Jacobian (residuals x unknowns) of the last linearisation.
  const Eigen::MatrixXd& jacobian() const;
  /// Returns the whitened residual of the last linearisation, one entry for each row of the Jacobian.
  const Eigen::VectorXd& residual() const;
  std::unique_ptr<LinearSolver> makeAnother() const override;

 private:
  struct Implementation;
};

}  // namespace slom
