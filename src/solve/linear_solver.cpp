#include "slom/solve/linear_solver.hpp"

#include <algorithm>

namespace slom {

/// Column by column.
SolveStatus LinearSolver::invertDiagonal(const BlockStructure& structure, std::vector<double>& blocks) {
  std::vector<double> all;
  Eigen::MatrixXd columns;
  for (int b = 0; b < structure.blockCount(); ++b) {
    const int first = structure.offset[static_cast<std::size_t>(b)], dof = structure.dof(b);
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(structure.unknowns(), dof);
    unit.middleRows(first, dof).setIdentity();
    const SolveStatus status = solveFor(unit, columns);
    if (!status.ok) return status;
    const Eigen::MatrixXd block = columns.middleRows(first, dof);
    all.insert(all.end(), block.data(), block.data() + block.size());
  }
  blocks = std::move(all);
  return {};
}

}  // namespace slom
