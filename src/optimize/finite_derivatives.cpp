#include "optimize/finite_derivatives.hpp"

namespace slom {

namespace {
/// Part of the way to a bound that is tried first, and the factor of each further one.
constexpr double kFirstPart = 0.9, kShorter = 0.5;
constexpr int kMostShorterSteps = 20;

/// Linearises; returns whether derivatives are finite.
bool areDerivativesFinite(Evaluator& evaluator) {
  try {
    evaluator.linearize();
    return true;
  } catch (const Error& error) {
    if (error.id() != "slom.not-finite") throw;
    return false;
  }
}
}  // namespace

void shortenToFiniteDerivatives(Evaluator& evaluator, StepOutcome& outcome) {
  if (outcome.kind != StepOutcome::Kind::taken || !evaluator.problem().activeSet().hasBounds() ||
      areDerivativesFinite(evaluator))
    return;
  evaluator.undo();
  outcome.step = kFirstPart * evaluator.withinBounds(outcome.step);
  outcome.is_undamped = false;
  for (int i = 0; i < kMostShorterSteps; ++i, outcome.step *= kShorter) {
    outcome.rss_after = evaluator.tryStep(outcome.step);
    if (outcome.rss_after < outcome.rss_before && areDerivativesFinite(evaluator)) return;
    evaluator.undo();
  }
  outcome.rss_after = outcome.rss_before;
  outcome.kind = StepOutcome::Kind::not_finite;
}

}  // namespace slom
