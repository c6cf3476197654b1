#include "slom/distributed/covariances.hpp"

#include <algorithm>
#include <string>

#include "distributed/index.hpp"
#include "distributed/messages.hpp"
#include "slom/linearize/linearize.hpp"

namespace slom::distributed {

using Eigen::MatrixXd;

namespace {

[[noreturn]] void refuseVariable(const std::string& id, const std::string& name, const std::string& what) {
  throw Error(id, "the covariance of variable " + name + ": " + what, name);
}

/// Throws for variables whose covariance this process cannot have.
void requireUnknowns(const Problem& table, const ProblemStructure& structure,
                     const std::vector<int>& variables) {
  for (const int v : variables) {
    if (structure.system.isEmpty(v) && table.activeSet().isOptimized(v))
      refuseVariable("slom.no-unknowns", table.variableName(v),
                     "no measurement of this process depends on it; ask in a process that has some");
  }
}

/// Returns the error of a singular system, from the process that knows the unknown; `unknown`: here, or -1.
Error singular(const Problem& table, const ProblemStructure& structure, int unknown, bool is_exact) {
  if (unknown < 0) {
    return {"slom.rank-deficient",
            is_exact ? "the measurements do not determine all unknowns, so there are no covariances; fix "
                       "variables or add measurements"
                     : "conjugate gradients find no column of the inverse of J^T J: the measurements do not "
                       "determine all unknowns, or hardly; fix variables or add measurements, or choose "
                       "PetscMethod::cholesky, which names an unknown"};
  }
  int variable = 0;
  for (int v = 0; v < structure.system.blockCount(); ++v) {
    if (!structure.system.isEmpty(v) && structure.offsetOf(v) <= unknown) variable = v;
  }
  const std::string name = table.componentNames(variable)[at(unknown - structure.offsetOf(variable))];
  return {"slom.rank-deficient",
          "the measurements do not determine " + name +
              ", alone or with others, so there are no covariances; fix variables or add measurements",
          name};
}

/// Throws if the solution failed in any process; the process that knows the unknown names it.
void requireSolved(const Collective& processes, const Problem& table, const ProblemStructure& structure,
                   SolveStatus status, bool is_exact) {
  if (processes.all(status.ok)) return;
  const bool is_named = processes.any(!status.ok && status.unknown >= 0);
  processes.agree([&] {
    if (!is_named || (!status.ok && status.unknown >= 0))
      throw singular(table, structure, status.unknown, is_exact);
  });
}

}  // namespace

Covariances::Covariances(const Estimator& est, PetscSolver& solver, const std::vector<AnyVarID>& ids)
    : table_(est.table()) {
  const Collective& processes = solver.collective();
  const ProblemStructure structure = makeStructure(table_);
  std::vector<int> variables;
  int rows = 0;
  processes.agree([&] {
    if (est.freeGauge() == FreeGauge::inner_constraints)
      throw Error("slom.needs-all",
                  "covariances of a free network need the whole problem, but each process has a part; fix a "
                  "variable, or analyse the values in a single process");
    for (const AnyVarID& id : ids) {
      const int v = table_.indexOf(id);
      if (!first_.emplace(v, rows).second) continue;
      variables.push_back(v);
      rows += table_.variables()[at(v)].dof;
    }
    requireUnknowns(table_, structure, variables);
  });
  C_ = MatrixXd::Zero(rows, rows);
  solver.analyze(structure.system);
  double rss = 0;
  processes.agree([&] { rss = Linearizer().linearize(table_, table_.activeSet(), solver); });
  solver.completeLinearization();
  const double factor =
      est.sigma() == Sigma::known ? 1 : varianceFactor(est, solver, structure, processes.sum(rss));
  solveFor(solver, structure, variables);
  C_ = (factor / 2 * (C_ + C_.transpose())).eval();
  for (const auto& [a, row] : first_) {
    for (const auto& [b, column] : first_) {
      MatrixXd of_pair = block(a, b);
      table_.activeSet().clear(a, int(of_pair.rows()), b, int(of_pair.cols()), of_pair.data());
      C_.block(row, column, of_pair.rows(), of_pair.cols()) = of_pair;
    }
  }
}

/// Solves for the columns of all processes, some at a time, and keeps the rows of `variables`.
void Covariances::solveFor(PetscSolver& solver, const ProblemStructure& structure,
                           const std::vector<int>& variables) {
  constexpr int most_columns = 32;
  const Processes processes;
  std::vector<std::pair<int, int>> unknowns;  // of the variables: the unknown, and its row in C_
  for (const int v : variables) {
    if (structure.system.isEmpty(v)) continue;
    for (int i = 0; i < structure.system.dof(v); ++i)
      unknowns.emplace_back(structure.offsetOf(v) + i, first_.at(v) + i);
  }
  const std::vector<int> counts = gathered(processes, std::vector<int>{int(unknowns.size())});
  for (int p = 0; p < processes.size(); ++p) {
    for (int begin = 0; begin < counts[at(p)]; begin += most_columns) {
      const int count = std::min(most_columns, counts[at(p)] - begin);
      MatrixXd B = MatrixXd::Zero(structure.system.unknowns(), count), X;
      for (int j = 0; p == processes.rank() && j < count; ++j) B(unknowns[at(begin + j)].first, j) = 1;
      SolveStatus status = solver.solveFor(B, X);
      for (int j = 0; status.ok && p == processes.rank() && j < count; ++j) {
        const auto [unknown, column] = unknowns[at(begin + j)];
        if (!(X(unknown, j) >= 0)) status = {false, unknown, 0, 0};
        for (const auto& [row_unknown, row] : unknowns) C_(row, column) = X(row_unknown, j);
      }
      requireSolved(processes, table_, structure, status, solver.isExact());
    }
  }
}

/// Returns the RSS of all measurements over their redundancy.
double Covariances::varianceFactor(const Estimator& est, const PetscSolver& solver,
                                   const ProblemStructure& structure, double rss) const {
  int unknowns = 0;
  for (int v = 0; v < structure.system.blockCount(); ++v) {
    if (structure.system.isEmpty(v) || !solver.collective().counts(v)) continue;
    for (int c = 0; c < structure.system.dof(v); ++c)
      unknowns += table_.activeSet().isFixedOrActive(v, c) ? 0 : 1;
  }
  const double residuals = solver.collective().sum(est.getM()),
               redundancy = residuals - solver.collective().sum(unknowns);
  if (redundancy > 0) return rss / redundancy;
  throw Error("slom.no-redundancy",
              "Sigma::estimated needs more residuals than unknowns, but all processes have " +
                  std::to_string(int(residuals)) + " residuals and " +
                  std::to_string(int(residuals - redundancy)) +
                  " unknowns; add measurements or use Sigma::known");
}

MatrixXd Covariances::block(int a, int b) const {
  for (const int v : {a, b}) {
    if (first_.count(v) == 0)
      refuseVariable("slom.not-asked", table_.variableName(v), "not computed; pass it to the constructor");
  }
  return C_.block(first_.at(a), first_.at(b), table_.variables()[at(a)].dof, table_.variables()[at(b)].dof);
}

}  // namespace slom::distributed
