/// Steps by preconditioned conjugate gradients on the reduced system, for systems whose factor would be too large.
#pragma once

#include <string>

#include "block_method.hpp"
#include "reduced_operator.hpp"

namespace slom {

class IterativeMethod final : public BlockMethod {
 public:
  /// Makes the method. `system` describes what is solved. The first `eliminated` columns of H are eliminated.
  IterativeMethod(std::string system, const BlockSolverOptions& options, const NormalEquations& equations,
                  int eliminated);

  SolveStatus solve(Eigen::VectorXd& x) override;
  std::unique_ptr<InverseBlocks> invertBlocks() override { return nullptr; }
  bool isExact() const override { return false; }
  double flops() const override { return 0; }
  std::string description() const override;

 private:
  SolveStatus factorize(const Eigen::VectorXd& damping, Eigen::VectorXd* x) override;
  SolveStatus finishStep(Eigen::VectorXd& x, bool is_forward_solved) override;
  /// Iterates. If `is_rough_enough`, a solution outside the tolerance counts too.
  SolveStatus iterate(double tolerance, int max_iterations, bool is_rough_enough, Eigen::VectorXd& x);
  double forcing();

  std::string system_;
  BlockSolverOptions options_;
  const NormalEquations& equations_;
  ReducedOperator reduced_;
  double largest_gradient_ = 0;
  int solutions_ = 0;
  double iterations_ = 0;  // of all solutions together
};

}  // namespace slom
