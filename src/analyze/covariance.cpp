#include "slom/analyze/covariance.hpp"

#include "analyze/diagnose.hpp"

namespace slom {

Eigen::MatrixXd covarianceBlock(System& system, Linearizer& linearizer, int variable_a, int variable_b) {
  system.linearize();
  const ProblemStructure& structure = system.structure();
  const auto& table = system.problem().variables();
  const int dof_a = table[static_cast<std::size_t>(variable_a)].dof;
  const int dof_b = table[static_cast<std::size_t>(variable_b)].dof;
  const int a = structure.offset_of_variable[static_cast<std::size_t>(variable_a)];
  const int b = structure.offset_of_variable[static_cast<std::size_t>(variable_b)];
  if (a < 0 || b < 0) return Eigen::MatrixXd::Zero(dof_a, dof_b);
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(structure.system.unknowns(), dof_b);
  unit.middleRows(b, dof_b).setIdentity();
  Eigen::MatrixXd columns;
  const SolveStatus status = system.solver().solveFor(unit, columns);
  if (!status.ok) throw undeterminedError(system, linearizer, status);
  const Eigen::MatrixXd block = columns.middleRows(a, dof_a);
  return variable_a == variable_b ? Eigen::MatrixXd((block + block.transpose()) / 2) : block;
}

std::unique_ptr<InverseBlocks> inverseBlocks(System& system, Linearizer& linearizer) {
  system.linearize();
  const ProblemStructure& structure = system.structure();
  std::unique_ptr<InverseBlocks> result;
  const SolveStatus status = system.solver().invertBlocks(structure.system, result);
  if (!status.ok) throw undeterminedError(system, linearizer, status);
  return result;
}

}  // namespace slom
