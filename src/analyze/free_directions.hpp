/// The null space of J, as the loop of a fit asks for it.
#pragma once

#include "analyze/linearized_problem.hpp"
#include "slom/optimize/optimizer.hpp"

namespace slom {

/// Empty where the problem has no unknowns.
FreeDirections findFreeDirections(const LinearizedProblem& linearized);

}  // namespace slom
