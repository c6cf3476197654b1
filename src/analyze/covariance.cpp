#include "analyze/covariance.hpp"

#include <algorithm>
#include <string>

#include "base/index.hpp"
#include "base/words.hpp"

namespace slom {

using Eigen::MatrixXd;

void clearConstrained(const LinearizedProblem& linearized, int variable_a, int variable_b, double* block) {
  const auto& table = linearized.problem().variables();
  linearized.activeSet().clear(variable_a, table[at(variable_a)].dof, variable_b, table[at(variable_b)].dof,
                               block);
}

MatrixXd covarianceBlock(const LinearizedProblem& linearized, FreeGauge gauge, int variable_a,
                         int variable_b) {
  const auto& table = linearized.problem().variables();
  const int dof_a = table[at(variable_a)].dof, dof_b = table[at(variable_b)].dof;
  const ProblemStructure& structure = linearized.structure();
  if (structure.system.isEmpty(variable_a) || structure.system.isEmpty(variable_b))
    return MatrixXd::Zero(dof_a, dof_b);
  const int a = structure.offsetOf(variable_a), b = structure.offsetOf(variable_b);
  MatrixXd block = linearized.covarianceColumns(gauge, b, dof_b).middleRows(a, dof_a);
  if (variable_a == variable_b) block = ((block + block.transpose()) / 2).eval();
  clearConstrained(linearized, variable_a, variable_b, block.data());
  return block;
}

namespace {

/// Returns whether some measurement depends on all these variables. Then the blocks of the inverse have all their pairs.
bool meet(const Problem& problem, const std::vector<int>& variables) {
  int rarest = -1, fewest = 0;
  for (const int v : variables) {
    int uses = 0;
    problem.forEachUse(v, [&](const MeasurementPool&, int) { ++uses; });
    if (rarest < 0 || uses < fewest) rarest = v, fewest = uses;
  }
  bool found = false;
  if (rarest < 0) return found;
  problem.forEachUse(rarest, [&](const MeasurementPool& pool, int i) {
    const int* const first = pool.variables(i);
    found = found || std::all_of(variables.begin(), variables.end(), [&](int v) {
              return std::find(first, first + pool.arity(), v) != first + pool.arity();
            });
  });
  return found;
}

/// Returns the joint covariance from the blocks of the inverse.
MatrixXd jointCovarianceFrom(const InverseBlocks& inverse, const LinearizedProblem& linearized,
                             const std::vector<int>& variables) {
  const auto& table = linearized.problem().variables();
  int n = 0;
  for (const int v : variables) n += table[at(v)].dof;
  MatrixXd C = MatrixXd::Zero(n, n), block;
  int column = 0;
  for (const int b : variables) {
    int row = 0;
    for (const int a : variables) {
      block.resize(table[at(a)].dof, table[at(b)].dof);
      if (!linearized.structure().system.isEmpty(a) && !linearized.structure().system.isEmpty(b)) {
        inverse.block(a, b, block.data());
        clearConstrained(linearized, a, b, block.data());
        C.block(row, column, block.rows(), block.cols()) = block;
      }
      row += table[at(a)].dof;
    }
    column += table[at(b)].dof;
  }
  return (C + C.transpose()) / 2;
}

}  // namespace

MatrixXd jointCovariance(const LinearizedProblem& linearized, FreeGauge gauge,
                         const std::vector<int>& variables) {
  if (const InverseBlocks* inverse = linearized.knownInverse(gauge);
      inverse && meet(linearized.problem(), variables))
    return jointCovarianceFrom(*inverse, linearized, variables);
  const auto& table = linearized.problem().variables();
  const ProblemStructure& structure = linearized.structure();
  int n = 0;
  for (const int v : variables) n += table[at(v)].dof;
  MatrixXd C = MatrixXd::Zero(n, n), block;
  int column = 0;
  for (const int b : variables) {
    MatrixXd columns;
    if (!structure.system.isEmpty(b))
      columns = linearized.covarianceColumns(gauge, structure.offsetOf(b), table[at(b)].dof);
    int row = 0;
    for (const int a : variables) {
      if (!structure.system.isEmpty(a) && !structure.system.isEmpty(b)) {
        block = columns.middleRows(structure.offsetOf(a), table[at(a)].dof);
        clearConstrained(linearized, a, b, block.data());
        C.block(row, column, block.rows(), block.cols()) = block;
      }
      row += table[at(a)].dof;
    }
    column += table[at(b)].dof;
  }
  return (C + C.transpose()) / 2;
}

void detail::requireCovarianceSize(Eigen::Index rows, Eigen::Index columns, int n) {
  if (rows == n && columns == n) return;
  const auto size = [](Eigen::Index a, Eigen::Index b) {
    return std::to_string(a) + " x " + std::to_string(b);
  };
  throw Error("slom.wrong-length",
              "propagate got a covariance of " + size(rows, columns) + ", but its variables have " +
                  counted(n, "degree") + " of freedom together; pass their joint covariance, " + size(n, n),
              "propagate");
}

void detail::propagate(const double* J, const double* C, int m, int n, double* out) {
  using Eigen::Map;
  const Map<const MatrixXd> jacobian(J, m, n), covariance(C, n, n);
  Map<MatrixXd>(out, m, m) = jacobian * covariance * jacobian.transpose();
}

}  // namespace slom
