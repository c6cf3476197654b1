#include "optimize/finite_derivatives.hpp"

namespace slom {

namespace {
/// Fraction of the way to a bound that is tried first, and the factor for each further one.
constexpr double kFirstPart = 0.9, kShorter = 0.5;
constexpr int kMostShorterSteps = 20;
}  // namespace

void shortenToFiniteDerivatives(Evaluator& evaluator, StepOutcome& outcome) {
  if (outcome.kind != StepOutcome::Kind::taken || evaluator.hasFiniteDerivatives()) return;
  evaluator.undo();
  outcome.step = kFirstPart * evaluator.withinBounds(outcome.step);
  outcome.is_undamped = false;
  for (int i = 0; i < kMostShorterSteps; ++i, outcome.step *= kShorter) {
    outcome.rss_after = evaluator.tryStep(outcome.step);
    if (outcome.rss_after < outcome.rss_before && evaluator.hasFiniteDerivatives()) return;
    evaluator.undo();
  }
  outcome.rss_after = outcome.rss_before;
  outcome.kind = StepOutcome::Kind::not_finite;
}

}  // namespace slom
