#include "optimize/convergence.hpp"

#include <algorithm>
#include <cmath>

namespace slom {

namespace {
/// Largest predicted decrease, as a fraction of a variance, that rounding may make unachievable.
constexpr double kMostRounding = 1e-4;
/// An RSS below these limits, absolute and relative to the first one, is rounding error.
constexpr double kPerfect = 1e-30, kLittleOfTheFirst = 1e-20;
/// Largest fraction of the RSS that rounding of values may change if rank is lost, and fraction above which the RSS is
/// rounding itself.
constexpr double kMostHidden = 1e-10, kIsRounding = 1e-2;
/// Cosine of residual and columns, for residuals without a scale. Below it, a damped step with a small decrease ends
/// the fit.
constexpr double kFlat = 1e-2;
/// Limit of gradients from central differences. Such differences have about 10 digits, so these gradients cannot be
/// smaller even if no step leads downhill.
constexpr double kNumericGradient = 1e-8;
}  // namespace

/// Returns the variance of residuals of unit weight. If it is not stated, the residuals may show that it is smaller
/// than 1.
double Convergence::variance(double rss) const {
  if (!sigma_is_estimated_ && is_stated_) return 1;
  const double estimated =
      rss / std::max(1, evaluator_.residuals() - evaluator_.unknowns() + evaluator_.fixedOrActiveCount());
  return sigma_is_estimated_ ? estimated : std::min(1.0, estimated);
}

double Convergence::mostNear(double rss) const {
  return options_.deviation_tolerance * options_.deviation_tolerance * variance(rss);
}

bool Convergence::isNear(double promised, double rss) const { return promised <= mostNear(rss); }

/// Returns whether rounding errors of the residuals hide the promise. Exact data leave residuals that are rounding errors
/// alone, and such residuals show no variance.
bool Convergence::isRounding(double promised, double rss) {
  const double rounding = evaluator_.roundingOfPromises();
  return promised <= rounding && (promised <= kMostRounding * variance(rss) || rounding >= kIsRounding * rss);
}

/// Returns the promise, marked as unknown if rank is lost and rounding matters. Residuals may be small differences of
/// large numbers (x - y with both near 1e9). Without full rank, they say nothing about directions in which these
/// numbers move together, unless all residuals are rounding.
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
  if (!outcome.status.ok) return std::nullopt;  // without full rank, the predicted decrease is unknown
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
  // Residuals without a scale are judged as in other libraries: by the decrease of a step that was not refused.
  const bool is_relative = std::isinf(options_.deviation_tolerance);
  if (is_relative && has_decrease && outcome.trials == 1 && gradient <= kFlat) return StopReason::decrease;
  if (!outcome.is_undamped) {
    // Each promise costs a factorisation, so only candidates 1, 2, 4, ... are tested.
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
    // If a function needs long steps for its differences, its values are no finer than these steps show.
    const double step = evaluator_.collective().max(evaluator_.problem().largestStatedStep());
    if (promise.decrease <= step * step * std::min(rss, variance(rss))) return StopReason::decrease;
  }
  const double tolerance =
      std::max(options_.gradient_tolerance, evaluator_.hasNumericDerivatives() ? kNumericGradient : 0);
  if (gradient > tolerance || gradient * gradient * rss > kMostRounding * variance(rss)) return std::nullopt;
  // If J loses its rank at the solution, the linear model predicts a decrease that no step achieves. The gradient then
  // shows the end for each unknown. If columns of J are nearly dependent, the gradient is small as well, but a step
  // achieves the predicted decrease.
  has_advanced_ = evaluator_.advance(promise);
  return has_advanced_ ? std::nullopt : std::optional(StopReason::gradient);
}

bool Convergence::isHidden() {
  constexpr double small = 1e-8;  // fraction of a variance: 1e-4 standard deviations
  const double rss = evaluator_.linearize();
  const Evaluator::Promise promise = promiseAt(rss, std::isfinite(options_.deviation_tolerance));
  return promise.is_known && promise.decrease <= Evaluator::kRounding * rss &&
         promise.decrease <= small * variance(rss);
}

}  // namespace slom
