#pragma once

#include "analyze/linearized_problem.hpp"
#include "slom/analyze/preflight.hpp"

namespace slom {

/// Evaluates everything once, compares derivatives, counts residuals against unknowns, and diagnoses the problem.
Preflight preflight(const LinearizedProblem& linearized);

}  // namespace slom
