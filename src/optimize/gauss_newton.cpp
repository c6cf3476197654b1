#include <cmath>

#include "optimize/named_list.hpp"
#include "slom/optimize/algorithm.hpp"
#include "slom/optimize/evaluator.hpp"

namespace slom {

std::string GaussNewton::name() const { return "Gauss-Newton"; }
std::unique_ptr<Algorithm> GaussNewton::clone() const { return std::make_unique<GaussNewton>(*this); }

StepOutcome GaussNewton::step(Evaluator& evaluator, const Options&) {
  StepOutcome outcome;
  outcome.rss_before = outcome.rss_after = evaluator.linearize();
  outcome.trials = 1;
  outcome.status = evaluator.solveUndamped(outcome.step);
  if (!outcome.status.ok) {
    outcome.kind = StepOutcome::Kind::singular;
    return outcome;
  }
  outcome.predicted_decrease = evaluator.predictedDecrease(outcome.step, {});
  outcome.is_undamped = evaluator.solver().isExact();
  const double rss = evaluator.tryLikelyStep(outcome.step);
  if (!std::isfinite(rss)) {
    evaluator.undo();
    outcome.kind = StepOutcome::Kind::not_finite;
    return outcome;
  }
  outcome.rss_after = rss;
  return outcome;
}

const NamedAlgorithm detail::algorithms::gauss_newton{
    "gn", "Gauss-Newton, with Levenberg-Marquardt if a step leads uphill", &makeAlgorithm<GaussNewton>};

}  // namespace slom
