/// Exact solutions, by a Cholesky factorisation of H, or of what an elimination leaves of it.
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
  /// `system` describes what is solved. `elimination` may be null. `rest`: the blocks of the structure that it leaves,
  /// ascending; the fronts are those of their graph.
  CholeskyMethod(std::string system, const BlockStructure& structure, const NormalEquations& equations,
                 std::unique_ptr<Elimination> elimination, const std::vector<int>& rest, Fronts fronts);

  SolveStatus solve(Eigen::VectorXd& x) override;
  std::unique_ptr<InverseBlocks> invertBlocks() override;
  bool isExact() const override { return true; }
  double flops() const override;
  std::string description() const override;

 private:
  SolveStatus factorize(const Eigen::VectorXd& damping, Eigen::VectorXd* x) override;
  SolveStatus finishStep(Eigen::VectorXd& x, bool is_forward_solved) override;
  void backSolve(Eigen::VectorXd& x);
  const BlockLower& matrix() const { return elimination_ ? elimination_->S() : equations_.H(); }
  Eigen::VectorXd kept(const Eigen::VectorXd& x) const;

  std::string system_;
  const NormalEquations& equations_;
  std::vector<int> position_;  // in H, of each block of the structure
  std::unique_ptr<Elimination> elimination_;
  std::vector<int> kept_;  // unknowns that the elimination leaves
  MultifrontalCholesky factor_;
};

}  // namespace slom
