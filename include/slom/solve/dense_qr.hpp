/// The slow, accurate reference: keeps J whole and solves by a column-pivoted QR decomposition, so that the condition
/// number is not squared. For small or ill-conditioned problems, and as the oracle of the other solvers.
#pragma once

#include "slom/solve/linear_solver.hpp"

namespace slom {

class DenseQR final : public LinearSolver {
 public:
  DenseQR();
  ~DenseQR() override;
  void analyze(const BlockStructure& structure) override;
  void beginLinearization() override;
  void add(const JacobianBatch& batch) override;
  void endLinearization() override;
  SolveStatus solve(const Eigen::VectorXd& damping, Eigen::VectorXd& step) override;
  const Eigen::VectorXd& gradient() const override { return gradient_; }
  const Eigen::VectorXd& diagonal() const override { return diagonal_; }
  double squaredImage(const Eigen::VectorXd& d) const override;
  SolveStatus solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) override;
  std::string description() const override;

  /// The whitened Jacobian (residuals x unknowns) and residual of the last linearisation.
  const Eigen::MatrixXd& jacobian() const { return J_; }
  const Eigen::VectorXd& residual() const { return r_; }

 private:
  BlockStructure structure_;
  Eigen::MatrixXd J_;
  Eigen::VectorXd r_, gradient_, diagonal_;
  std::vector<double> rows_;      // row after row while they come in
  std::vector<double> residual_;  // likewise
};

}  // namespace slom
