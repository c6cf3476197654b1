/// The default solver: block-sparse normal equations, factorised by a multifrontal block Cholesky decomposition.
#pragma once

#include <memory>

#include "slom/solve/linear_solver.hpp"

namespace slom {

/// Solves (J^T J + damping) d = -J^T r. The order of elimination and the layout of the factor are found on the graph of
/// variables, once for each structure. Dense arithmetic is chosen for the processor at run time.
class BlockCholesky final : public LinearSolver {
 public:
  BlockCholesky();
  ~BlockCholesky() override;
  void analyze(const BlockStructure& structure) override;
  void beginLinearization() override;
  void add(const JacobianBatch& batch) override;
  void addAll(std::span<const JacobianBatch> batches) override;
  void endLinearization() override;
  SolveStatus solve(const Eigen::VectorXd& damping, Eigen::VectorXd& step) override;
  const Eigen::VectorXd& gradient() const override;
  const Eigen::VectorXd& diagonal() const override;
  double squaredImage(const Eigen::VectorXd& d) const override;
  SolveStatus solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) override;
  std::string description() const override;

  /// Additions and multiplications of one factorisation.
  double flops() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> self_;
};

}  // namespace slom
