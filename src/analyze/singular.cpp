#include "analyze/singular.hpp"

#include "base/words.hpp"
#include "slom/solve/block_qr.hpp"

namespace slom {

std::string unmeasured(const std::string& name) {
  return "no measurement depends on variable " + name +
         ", so nothing determines it; add measurements or fix it with fix(id)";
}

std::string unconvergedLine(const std::string& reason) {
  return reason.empty() ? ""
                        : "the last fit has not converged (" + reason +
                              "); the following holds at the values where it ended\n";
}

std::string unknownName(const Problem& problem, const ProblemStructure& structure, int unknown) {
  const int variable = variableOf(structure, unknown), component = unknown - structure.offsetOf(variable);
  return problem.componentNames(variable)[static_cast<std::size_t>(component)];
}

Error singularError(const Problem& problem, const ProblemStructure& structure, const SolveStatus& status) {
  const bool is_named = status.unknown >= 0 && status.unknown < structure.system.unknowns();
  if (!is_named) {  // the solver is the user's own
    return {
        "slom.rank-deficient",
        "the solver found no unique solution and does not name an unknown; slom::diagnose(est) lists what is not determined"};
  }
  const int variable = variableOf(structure, status.unknown);
  if (problem.variables()[static_cast<std::size_t>(variable)].uses == 0) {
    const std::string name = problem.variableName(variable);
    return {"slom.unmeasured-variable", unmeasured(name), name};
  }
  const std::string limit = status.least > 0 ? "given the other unknowns, less than " + number(status.least) +
                                                   " of its column of the Jacobian remains, so "
                                             : "";
  const std::string name = unknownName(problem, structure, status.unknown);
  return {"slom.rank-deficient",
          "the measurements do not determine " + name + ": " + limit +
              "it can move, alone or with others, without changing any residual; add measurements or a "
              "prior, fix a variable with fix(id) or a part of it with fix(id, \"path\"), or use "
              "LevenbergMarquardt to get one of the many solutions" +
              (status.least > BlockQR::kPivotTolerance
                   ? ", or BlockQR, which needs " + number(BlockQR::kPivotTolerance)
                   : ""),
          name};
}

std::vector<std::string> unmeasuredVariables(const Problem& problem) {
  std::vector<std::string> result;
  const auto& table = problem.variables();
  for (std::size_t v = 0; v < table.size(); ++v) {
    if (table[v].store == nullptr || !problem.activeSet().isOptimized(static_cast<int>(v)) ||
        table[v].uses > 0)
      continue;
    result.push_back(unmeasured(problem.variableName(static_cast<int>(v))));
  }
  return result;
}

}  // namespace slom
