#include "slom/analyze/covariance.hpp"

#include "analyze/diagnose.hpp"
#include "analyze/free_network.hpp"
#include "slom/analyze/uncertainty.hpp"

namespace slom {

void clearHeld(const Problem& problem, int variable_a, int variable_b, double* block) {
  const VariableRecord& a = problem.variables()[static_cast<std::size_t>(variable_a)];
  const VariableRecord& b = problem.variables()[static_cast<std::size_t>(variable_b)];
  const ActiveSet& active = problem.activeSet();
  if (!active.isConstrained(variable_a) && !active.isConstrained(variable_b)) return;
  for (int j = 0; j < b.dof; ++j) {
    for (int i = 0; i < a.dof; ++i, ++block) {
      if (active.isHeld(variable_a, i) || active.isHeld(variable_b, j)) *block = 0;
    }
  }
}

namespace {

/// `count` columns of (J^T J)^-1 from `first` on.
Eigen::MatrixXd covarianceColumns(System& system, Linearizer& linearizer, FreeGauge gauge, int first,
                                  int count) {
  if (gauge == FreeGauge::inner_constraints) return FreeNetwork(system, linearizer).columns(first, count);
  Eigen::MatrixXd columns, unit = Eigen::MatrixXd::Zero(system.structure().system.unknowns(), count);
  unit.middleRows(first, count).setIdentity();
  const SolveStatus status = system.solveFor(unit, columns);
  if (!status.ok) throw undeterminedError(system, linearizer, status);
  for (int i = 0; i < count; ++i) {  // conjugate gradients do not notice a loss of rank
    if (!(columns(first + i, i) >= 0))
      throw undeterminedError(system, linearizer, SolveStatus{false, first + i, 0, 0});
  }
  return columns;
}

}  // namespace

Eigen::MatrixXd covarianceOfAll(System& system, Linearizer& linearizer, FreeGauge gauge) {
  system.linearize();
  return covarianceColumns(system, linearizer, gauge, 0, system.structure().system.unknowns());
}

Eigen::MatrixXd covarianceBlock(System& system, Linearizer& linearizer, FreeGauge gauge, int variable_a,
                                int variable_b) {
  system.linearize();
  const ProblemStructure& structure = system.structure();
  const auto& table = system.problem().variables();
  const int dof_a = table[static_cast<std::size_t>(variable_a)].dof;
  const int dof_b = table[static_cast<std::size_t>(variable_b)].dof;
  const int a = structure.offset_of_variable[static_cast<std::size_t>(variable_a)];
  const int b = structure.offset_of_variable[static_cast<std::size_t>(variable_b)];
  if (a < 0 || b < 0) return Eigen::MatrixXd::Zero(dof_a, dof_b);
  Eigen::MatrixXd block = covarianceColumns(system, linearizer, gauge, b, dof_b).middleRows(a, dof_a);
  if (variable_a == variable_b) block = ((block + block.transpose()) / 2).eval();
  clearHeld(system.problem(), variable_a, variable_b, block.data());
  return block;
}

void detail::propagate(const double* J, const double* C, int m, int n, double* out) {
  using Eigen::Map;
  using Eigen::MatrixXd;
  const Map<const MatrixXd> jacobian(J, m, n), covariance(C, n, n);
  Map<MatrixXd>(out, m, m) = jacobian * covariance * jacobian.transpose();
}

std::unique_ptr<InverseBlocks> inverseBlocks(System& system, Linearizer& linearizer, FreeGauge gauge) {
  system.linearize();
  if (gauge == FreeGauge::inner_constraints) return std::make_unique<FreeNetwork>(system, linearizer);
  std::unique_ptr<InverseBlocks> result;
  const SolveStatus status = system.invertBlocks(result);
  if (!status.ok) throw undeterminedError(system, linearizer, status);
  return result;
}

}  // namespace slom
