#include "analyze/covariance.hpp"

#include "base/index.hpp"

namespace slom {

using Eigen::MatrixXd;

void clearHeld(const LinearizedProblem& linearized, int variable_a, int variable_b, double* block) {
  const auto& table = linearized.problem().variables();
  const ActiveSet& active = linearized.activeSet();
  if (!active.isConstrained(variable_a) && !active.isConstrained(variable_b)) return;
  for (int j = 0; j < table[at(variable_b)].dof; ++j) {
    for (int i = 0; i < table[at(variable_a)].dof; ++i, ++block) {
      if (active.isHeld(variable_a, i) || active.isHeld(variable_b, j)) *block = 0;
    }
  }
}

MatrixXd covarianceBlock(const LinearizedProblem& linearized, FreeGauge gauge, int variable_a,
                         int variable_b) {
  const auto& table = linearized.problem().variables();
  const int dof_a = table[at(variable_a)].dof, dof_b = table[at(variable_b)].dof;
  const auto& offset = linearized.structure().offset_of_variable;
  const int a = offset[at(variable_a)], b = offset[at(variable_b)];
  if (a < 0 || b < 0) return MatrixXd::Zero(dof_a, dof_b);
  MatrixXd block = linearized.covarianceColumns(gauge, b, dof_b).middleRows(a, dof_a);
  if (variable_a == variable_b) block = ((block + block.transpose()) / 2).eval();
  clearHeld(linearized, variable_a, variable_b, block.data());
  return block;
}

void detail::propagate(const double* J, const double* C, int m, int n, double* out) {
  using Eigen::Map;
  const Map<const MatrixXd> jacobian(J, m, n), covariance(C, n, n);
  Map<MatrixXd>(out, m, m) = jacobian * covariance * jacobian.transpose();
}

}  // namespace slom
