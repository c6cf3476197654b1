/// Reasons why a linear system could not be solved, with the user's names.
#pragma once

#include <string>
#include <vector>

#include "linearize/variable_of.hpp"
#include "slom/optimize/evaluator.hpp"

namespace slom {

/// Returns the name of an unknown of the linear system: variable and component, such as `left2world #3.orient.z`.
std::string unknownName(const Problem& problem, const ProblemStructure& structure, int unknown);

/// Returns the reason why the linear system could not be solved, as an error with a remedy: [slom.unmeasured-variable]
/// or [slom.rank-deficient].
Error singularError(const Problem& problem, const ProblemStructure& structure, const SolveStatus& status);

/// Returns the sentence about a variable that no measurement depends on.
std::string unmeasured(const std::string& name);

/// Returns a sentence for each optimised variable that no measurement depends on.
std::vector<std::string> unmeasuredVariables(const Problem& problem);

/// Returns the first line of reports on a fit that ended without convergence, for this reason; empty if `reason` is
/// empty.
std::string unconvergedLine(const std::string& reason);

}  // namespace slom
