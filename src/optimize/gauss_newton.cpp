#include <cmath>

#include "optimize/named_list.hpp"
#include "slom/optimize/algorithm.hpp"
#include "slom/optimize/system.hpp"

namespace slom {

std::string GaussNewton::name() const { return "Gauss-Newton"; }
std::unique_ptr<Algorithm> GaussNewton::clone() const { return std::make_unique<GaussNewton>(*this); }

StepOutcome GaussNewton::step(System& system, const Options&) {
  StepOutcome outcome;
  outcome.rss_before = outcome.rss_after = system.linearize();
  outcome.trials = 1;
  outcome.status = system.solveUndamped(outcome.step);
  if (!outcome.status.ok) {
    outcome.kind = StepOutcome::Kind::singular;
    return outcome;
  }
  outcome.predicted_decrease = system.predictedDecrease(outcome.step, {});
  outcome.is_undamped = system.solver().isExact();
  const double rss = system.tryLikelyStep(outcome.step);
  if (!std::isfinite(rss)) {
    system.undo();
    outcome.kind = StepOutcome::Kind::not_finite;
    return outcome;
  }
  outcome.rss_after = rss;
  return outcome;
}

const NamedAlgorithm detail::algorithms::gauss_newton{
    "gn", "Gauss-Newton, which goes on as Levenberg-Marquardt where it leads uphill",
    &makeAlgorithm<GaussNewton>};

}  // namespace slom
