/// Steps to points without finite derivatives, such as those of sqrt(limit - x) at a bound or 1 / (1 + exp(x)) for a
/// large x.
#pragma once

#include "slom/optimize/algorithm.hpp"
#include "slom/optimize/evaluator.hpp"

namespace slom {

/// Linearises at the end of a step that an algorithm took. If derivatives are not finite there, replaces the step by a
/// part of it with finite derivatives and a smaller RSS. If there is no such part, the outcome is not_finite and the
/// values before the step return. The library's algorithms check derivatives themselves, except GaussNewton, which has
/// no damping to raise.
void shortenToFiniteDerivatives(Evaluator& evaluator, StepOutcome& outcome);

}  // namespace slom
