/// Exact solutions by a Cholesky factorisation of H, or of the reduced system after an elimination.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "block_method.hpp"
#include "elimination.hpp"
#include "multifrontal.hpp"

namespace slom {

class CholeskyMethod final : public BlockMethod {
 public:
  /// Makes the method. `system` describes what is solved. `elimination` may be null. `rest`: the blocks of the
  /// structure that remain after it, ascending. `fronts` are those of the graph of `rest`.
  CholeskyMethod(std::string system, const BlockStructure& structure, const NormalEquations& equations,
                 std::unique_ptr<Elimination> elimination, const std::vector<int>& rest, Fronts fronts);

  SolveStatus solve(Eigen::VectorXd& x) override;
  SolveStatus solveColumns(Eigen::MatrixXd& X) override;
  std::unique_ptr<InverseBlocks> invertBlocks() override;
  bool isExact() const override { return true; }
  double flops() const override;
  std::string description() const override;

 private:
  SolveStatus factorize(const Eigen::VectorXd& damping, Eigen::VectorXd* x) override;
  SolveStatus finishStep(Eigen::VectorXd& x, bool is_forward_solved) override;
  void backSolve(Eigen::VectorXd& x);
  void solveAlone(Eigen::VectorXd& x, MultifrontalCholesky::Workspace& workspace) const;
  const BlockLower& matrix() const { return elimination_ ? elimination_->S() : equations_.H(); }
  Eigen::VectorXd kept(const Eigen::VectorXd& x) const;

  std::string system_;
  const NormalEquations& equations_;
  std::vector<int> position_;  // by block of the structure: its position in H
  std::unique_ptr<Elimination> elimination_;
  std::vector<int> kept_;  // unknowns that the elimination keeps
  MultifrontalCholesky factor_;
};

}  // namespace slom
