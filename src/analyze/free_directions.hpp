/// The null space of J in the form that the loop of a fit needs.
#pragma once

#include "analyze/linearized_problem.hpp"
#include "slom/optimize/optimizer.hpp"

namespace slom {

/// Finds the free directions; none if the problem has no unknowns.
FreeDirections findFreeDirections(const LinearizedProblem& linearized);

}  // namespace slom
