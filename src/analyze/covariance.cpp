#include "slom/analyze/covariance.hpp"

#include "analyze/diagnose.hpp"
#include "analyze/free_network.hpp"
#include "slom/analyze/uncertainty.hpp"

namespace slom {

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
  Eigen::MatrixXd columns;
  if (gauge == FreeGauge::inner_constraints) {
    columns = FreeNetwork(system, linearizer).columns(b, dof_b);
  } else {
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(structure.system.unknowns(), dof_b);
    unit.middleRows(b, dof_b).setIdentity();
    const SolveStatus status = system.solveFor(unit, columns);
    if (!status.ok) throw undeterminedError(system, linearizer, status);
    for (int i = 0; i < dof_b; ++i) {  // conjugate gradients do not notice a loss of rank
      if (!(columns(b + i, i) >= 0))
        throw undeterminedError(system, linearizer, SolveStatus{false, b + i, 0, 0});
    }
  }
  const Eigen::MatrixXd block = columns.middleRows(a, dof_a);
  return variable_a == variable_b ? Eigen::MatrixXd((block + block.transpose()) / 2) : block;
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
