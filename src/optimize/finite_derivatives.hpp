/// Steps to a bound at which derivatives are not finite, as those of sqrt(limit - x) are.
#pragma once

#include "slom/optimize/algorithm.hpp"
#include "slom/optimize/evaluator.hpp"

namespace slom {

/// Linearises at the end of a step that was taken; where derivatives are not finite there, takes a part of the step in its place. Without
/// bounds nothing is done. The outcome is not_finite, at the values before the step, where no part has finite derivatives and a
/// smaller RSS.
void shortenToFiniteDerivatives(Evaluator& evaluator, StepOutcome& outcome);

}  // namespace slom
