/// Why a linear system could not be solved, in the user's names.
#pragma once

#include <string>
#include <vector>

#include "linearize/variable_of.hpp"
#include "slom/optimize/evaluator.hpp"

namespace slom {

/// `left2world #3.orient.z`: the component of a variable that an unknown of the linear system is.
std::string unknownName(const Problem& problem, const ProblemStructure& structure, int unknown);

/// Why the linear system could not be solved, as an error with a remedy: [slom.unmeasured-variable] or
/// [slom.rank-deficient].
Error singularError(const Problem& problem, const ProblemStructure& structure, const SolveStatus& status);

/// The sentence on a variable that no measurement depends on.
std::string unmeasured(const std::string& name);

/// A sentence for each optimised variable that no measurement depends on.
std::vector<std::string> unmeasuredVariables(const Problem& problem);

/// The first line of what is said of values at which a fit has ended without having converged, for this reason; empty without one.
std::string unconvergedLine(const std::string& reason);

}  // namespace slom
