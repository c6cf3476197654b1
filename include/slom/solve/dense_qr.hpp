/// The slow, accurate reference: keeps J whole and solves by a column-pivoted QR decomposition, so that the condition
/// number is not squared. For small or ill-conditioned problems, and as the oracle of the other solvers.
#pragma once

#include "slom/model/pimpl.hpp"
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
  const Eigen::VectorXd& gradient() const override;
  const Eigen::VectorXd& diagonal() const override;
  double squaredNormOfJd(const Eigen::VectorXd& d) const override;
  SolveStatus solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) override;
  double leastOfColumn() const override;
  std::string description() const override;

  /// The whitened Jacobian (residuals x unknowns) and residual of the last linearisation.
  const Eigen::MatrixXd& jacobian() const;
  const Eigen::VectorXd& residual() const;

 private:
  struct Implementation;
  detail::Pimpl<Implementation> impl_;
};

}  // namespace slom
