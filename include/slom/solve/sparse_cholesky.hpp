/// Normal equations in blocks, factorised by a sparse LDL^T.
///   ordering   approximate minimum degree on the graph of variables
///   storage    lower triangle of the permuted H, column block after column block, each a dense panel
///   factor     Eigen's simplicial LDL^T
///   rank       an unknown is undetermined when its pivot D_jj is below 1e-12 of H_jj, i.e. when the other unknowns
///              reproduce its column of J but for a relative 1e-6
#pragma once

#include <memory>

#include "slom/solve/linear_solver.hpp"

namespace slom {

class SparseCholesky final : public LinearSolver {
 public:
  SparseCholesky();
  ~SparseCholesky() override;

  void analyze(const BlockStructure& structure) override;
  void beginLinearization() override;
  void add(const JacobianBatch& batch) override;
  void endLinearization() override;
  SolveStatus solve(const Eigen::VectorXd& damping, Eigen::VectorXd& step) override;
  const Eigen::VectorXd& gradient() const override;
  const Eigen::VectorXd& diagonal() const override;
  double squaredImage(const Eigen::VectorXd& d) const override;
  SolveStatus solveFor(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) override;
  std::string description() const override;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> self_;
};

}  // namespace slom
