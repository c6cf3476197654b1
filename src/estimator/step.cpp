// One step of the algorithm, and its record.
#include <ostream>
#include <string>

#include "analyze/singular.hpp"
#include "base/stopwatch.hpp"
#include "base/words.hpp"
#include "estimator/state.hpp"
#include "slom/optimize/step_record.hpp"

namespace slom {

namespace {

[[noreturn]] void raiseNotFinite(const std::string& algorithm) {
  throw Error("slom.not-finite",
              "the step of " + algorithm +
                  " led to values at which a residual is not finite, and was taken back; start "
                  "nearer to the solution, or use LevenbergMarquardt",
              algorithm);
}

}  // namespace

StepRecord Estimator::optimizeStep() {
  State& state = *state_;
  state.current.reset();
  StepRecord record;
  const PhaseSeconds before = state.evaluator.seconds();
  const StepOutcome outcome = [&] {
    const detail::Stopwatch watch(record.seconds);
    return state.run([&] { return state.algorithm->step(state.evaluator, Options{}); });
  }();
  const PhaseSeconds after = state.evaluator.seconds();
  if (outcome.kind == StepOutcome::Kind::singular)
    throw singularError(problem(), state.evaluator.structure(), outcome.status);
  if (outcome.kind == StepOutcome::Kind::not_finite) raiseNotFinite(state.algorithm->name());
  record.phases = {after.setup - before.setup, after.linearize - before.linearize,
                   after.factorize - before.factorize, after.solve - before.solve};
  record.rss_before = outcome.rss_before;
  record.rss_after = outcome.rss_after;
  record.gain = outcome.rss_before > 0 ? (outcome.rss_before - outcome.rss_after) / outcome.rss_before : 0.0;
  record.is_accepted = outcome.kind == StepOutcome::Kind::taken;
  record.trials = outcome.trials;
  record.damping = outcome.damping;
  record.free_directions = state.freeDirectionsAfterStep(outcome);
  return record;
}

int Estimator::State::freeDirectionsAfterStep(const StepOutcome& outcome) {
  const ProblemStructure& structure = evaluator.structure();
  if (structure.system.unknowns() == 0 || (outcome.is_undamped && evaluator.hadFullRank())) return 0;
  if (structure.system.unknowns() > StepRecord::kMostUnknowns ||
      structure.residuals > StepRecord::kMostResiduals)
    return StepRecord::kNotCounted;
  try {
    return analyze([](const LinearizedProblem& linearized) { return linearized.freeDirections(); });
  } catch (const Error&) {  // no derivatives at the end of the step
    return StepRecord::kNotCounted;
  }
}

std::ostream& operator<<(std::ostream& os, const StepRecord& step) {
  std::string text = "RSS " + number(step.rss_before, 6) + " -> " + number(step.rss_after, 6) + ", gain " +
                     number(step.gain, 3);
  if (!step.is_accepted) text += ", no step accepted";
  if (step.trials > 1) text += ", " + counted(step.trials, "trial");
  if (step.damping > 0) text += ", damping " + number(step.damping, 3);
  if (step.free_directions > 0) text += ", " + counted(step.free_directions, "free direction");
  const PhaseSeconds& phases = step.phases;
  return os << text << "; " << number(step.seconds, 3) << " s: setup " << number(phases.setup, 2)
            << ", linearize " << number(phases.linearize, 2) << ", factorize " << number(phases.factorize, 2)
            << ", solve " << number(phases.solve, 2);
}

}  // namespace slom
