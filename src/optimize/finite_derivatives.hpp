/// Steps to where derivatives are not finite, as those of sqrt(limit - x) at a bound or of 1 / (1 + exp(x)) for a large x.
#pragma once

#include "slom/optimize/algorithm.hpp"
#include "slom/optimize/evaluator.hpp"

namespace slom {

/// Linearises at the end of a step that an algorithm has taken. If derivatives are not finite there, replaces the step by a part of it that
/// ends where they are and has a smaller RSS. If there is none, the outcome is not_finite and the values are those before the step.
/// The algorithms of the library ask by themselves, except GaussNewton, which has no damping to raise.
void shortenToFiniteDerivatives(Evaluator& evaluator, StepOutcome& outcome);

}  // namespace slom
