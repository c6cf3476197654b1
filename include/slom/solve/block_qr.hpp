/// The square-root path: a sparse QR decomposition of the Jacobian, for ill-conditioned problems.
#pragma once

#include "slom/model/pimpl.hpp"
#include "slom/solve/linear_solver.hpp"

namespace slom {

/// Minimises |r + J d|^2 + sum_i damping_i d_i^2 by J = Q R, without J^T J: the condition number is not squared, so that
/// twice as many digits are left of what the data determine weakly. It takes several times as long as a BlockSolver.
class BlockQR final : public LinearSolver {
 public:
  /// The rank runs out where less than this share is left of the length of a column.
  static constexpr double kPivotTolerance = 1e-12;
  explicit BlockQR(double pivot_tolerance = kPivotTolerance);
  ~BlockQR() override;
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

 private:
  struct Implementation;
  detail::Pimpl<Implementation> impl_;
};

}  // namespace slom
