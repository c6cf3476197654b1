#include "optimize/convergence.hpp"

#include <algorithm>
#include <cmath>

namespace slom {

namespace {
/// Largest predicted decrease, as a share of a variance, that rounding may make unachievable.
constexpr double kMostRounding = 1e-4;
/// An RSS below these limits, absolute and relative to the first one, is rounding error.
constexpr double kPerfect = 1e-30, kLittleOfTheFirst = 1e-20;
/// Largest share of the RSS that rounding of the values may change where rank is lost, and share above which the RSS is rounding itself.
constexpr double kMostHidden = 1e-10, kIsRounding = 1e-2;
/// Where residuals have no scale, the cosine of residual and columns below which a small decrease by a damped
/// step is the end.
constexpr double kFlat = 1e-2;
/// Central differences have some ten digits, and where no step leads downhill, gradients from them cannot be
/// smaller.
constexpr double kNumericGradient = 1e-8;
}  // namespace

/// The variance of residuals of unit weight. Where it is not stated, the residuals may show that it is smaller
/// than 1.
double Convergence::variance(double rss) const {
  if (!sigma_is_estimated_ && is_stated_) return 1;
  const ProblemStructure& structure = evaluator_.structure();
  const double estimated = rss / std::max(1, structure.residuals - structure.system.unknowns() +
                                                 evaluator_.problem().activeSet().fixedOrActiveCount());
  return sigma_is_estimated_ ? estimated : std::min(1.0, estimated);
}

double Convergence::mostNear(double rss) const {
  return options_.deviation_tolerance * options_.deviation_tolerance * variance(rss);
}

bool Convergence::isNear(double promised, double rss) const { return promised <= mostNear(rss); }

bool Convergence::isRounding(double promised, double rss) {
  return promised <= kMostRounding * variance(rss) && promised <= evaluator_.roundingOfPromises();
}

/// Without full rank, residuals that are small differences of large numbers (x - y with both near 1e9) say nothing of
/// directions in which these move together, unless all of them is rounding.
Evaluator::Promise Convergence::promiseAt(double rss, bool carefully, double most) {
  Evaluator::Promise promise = evaluator_.promise(carefully, most);
  if (!promise.is_known || promise.has_full_rank) return promise;
  const double rounding = evaluator_.roundingOfPromises();
  promise.is_known = rounding <= kMostHidden * rss || rounding >= kIsRounding * rss;
  return promise;
}

std::optional<StopReason> Convergence::afterStep(const StepOutcome& outcome, double gradient,
                                                 double decrease_tolerance) {
  const double perfect = std::max(kPerfect, decrease_tolerance * decrease_tolerance);
  if (outcome.rss_after <= perfect && outcome.rss_after <= kLittleOfTheFirst * first_rss_)
    return StopReason::decrease;
  if (!outcome.status.ok) return std::nullopt;  // without full rank the predicted decrease is not known
  const double little = decrease_tolerance * outcome.rss_before;
  const bool has_gradient = gradient <= options_.gradient_tolerance;
  bool has_decrease =
      std::abs(outcome.rss_before - outcome.rss_after) <= little && outcome.predicted_decrease <= little;
  bool has_step = evaluator_.isNegligible(outcome.step, options_.step_tolerance);
  if (!has_gradient && !has_decrease && !has_step) {
    candidates_ = 0;
    return std::nullopt;
  }
  double promised = outcome.predicted_decrease;
  if (!evaluator_.solver().isExact()) promised = std::max(promised, gradient * gradient * outcome.rss_before);
  // Residuals without a scale are judged as other libraries do: by the decrease of a step that was not refused.
  const bool is_relative = std::isinf(options_.deviation_tolerance);
  if (is_relative && has_decrease && outcome.trials == 1 && gradient <= kFlat) return StopReason::decrease;
  if (!outcome.is_undamped) {
    // Each answer costs a factorisation.
    if (++candidates_; (candidates_ & (candidates_ - 1)) != 0) return std::nullopt;
    const Evaluator::Promise promise =
        promiseAt(outcome.rss_after, !is_relative, mostNear(outcome.rss_after));
    if (!promise.is_known) return std::nullopt;
    promised = promise.decrease;
    has_decrease = has_decrease && promised <= little;
    has_step = has_step && evaluator_.isNegligible(promise.step, options_.step_tolerance);
  }
  if (!isNear(promised, outcome.rss_after)) return std::nullopt;
  if (has_gradient) return StopReason::gradient;
  if (has_decrease) return StopReason::decrease;
  return has_step ? std::optional(StopReason::step) : std::nullopt;
}

bool Convergence::creeps(const StepOutcome& outcome) {
  constexpr int many = 50;
  if (std::abs(outcome.rss_before - outcome.rss_after) > Evaluator::kNoise * outcome.rss_before) {
    hidden_steps_ = 0;
    hidden_promise_ = std::numeric_limits<double>::infinity();
  } else if (++hidden_steps_ % many == 0) {
    const double promised = evaluator_.promise().decrease;
    if (!(promised < hidden_promise_ / 2)) return true;
    hidden_promise_ = promised;
  }
  return false;
}

std::optional<StopReason> Convergence::whenStuck(double gradient, double decrease_tolerance, bool has_rank) {
  has_advanced_ = false;
  const double rss = evaluator_.linearize();
  Evaluator::Promise promise;
  if (has_rank) promise = promiseAt(rss, std::isfinite(options_.deviation_tolerance));
  if (promise.is_known) {
    if (isRounding(promise.decrease, rss)) return StopReason::decrease;
    if (isNear(promise.decrease, rss)) {
      if (promise.decrease <= std::max(decrease_tolerance, Evaluator::kRounding) * rss)
        return StopReason::decrease;
      if (evaluator_.isNegligible(promise.step, options_.step_tolerance)) return StopReason::step;
    }
    // A function that needs long steps of its differences has no finer values than they show.
    const double step = evaluator_.problem().largestStatedStep();
    if (promise.decrease <= step * step * std::min(rss, variance(rss))) return StopReason::decrease;
  }
  const double tolerance = std::max(options_.gradient_tolerance,
                                    evaluator_.problem().hasNumericDerivatives() ? kNumericGradient : 0);
  if (gradient > tolerance || gradient * gradient * rss > kMostRounding * variance(rss)) return std::nullopt;
  // Where J loses its rank at the solution, the linear model predicts a decrease that no step achieves, and the
  // gradient shows it for each unknown. Where columns of J are nearly dependent, it does so too; but then
  // the prediction comes true.
  has_advanced_ = evaluator_.advance(promise);
  return has_advanced_ ? std::nullopt : std::optional(StopReason::gradient);
}

bool Convergence::isHidden() {
  constexpr double small = 1e-8;  // share of a variance: 1e-4 standard deviations
  const double rss = evaluator_.linearize();
  const Evaluator::Promise promise = promiseAt(rss, std::isfinite(options_.deviation_tolerance));
  return promise.is_known && promise.decrease <= Evaluator::kRounding * rss &&
         promise.decrease <= small * variance(rss);
}

}  // namespace slom
