#include "optimize/safeguarded_gauss_newton.hpp"

#include <algorithm>
#include <cmath>

#include "slom/optimize/evaluator.hpp"

namespace slom {

namespace {
constexpr int kLarge = 60;       // number of unknowns
constexpr int kUphillSteps = 2;  // successive ones, in large problems
constexpr int kMostPatience = 16;
constexpr double kGoodGain = 0.75;  // least actual / predicted decrease of a good step
}  // namespace

std::unique_ptr<Algorithm> Algorithm::safeguarded() const { return nullptr; }

std::unique_ptr<Algorithm> GaussNewton::safeguarded() const {
  return std::make_unique<SafeguardedGaussNewton>();
}

std::string SafeguardedGaussNewton::name() const { return was_newton_ ? newton_.name() : damped_.name(); }

void SafeguardedGaussNewton::reset() {
  damped_.reset();
  is_newton_ = was_newton_ = true;
  good_steps_ = 0;
  patience_ = 1;
  best_.reset();
  uphill_ = 0;
}

/// Returns whether the step stays. If rounding hides the change of the RSS, the predicted decrease decides.
bool SafeguardedGaussNewton::isAcceptable(Evaluator& evaluator, const StepOutcome& outcome) {
  if (best_ != nullptr) {
    if (outcome.rss_after < best_rss_) {
      best_.reset();
      return true;
    }
    return ++uphill_ <= kUphillSteps;
  }
  if (outcome.rss_after <= outcome.rss_before) return true;
  // With first estimates, the gradient is not that of the RSS, and the RSS may rise on a step to the gradient's root.
  // The predicted decrease, which is 0 at the root, decides.
  if (evaluator.hasFirstEstimates()) return evaluator.cameCloser({}, outcome.predicted_decrease);
  const bool is_judged = !evaluator.mayBeRounding(outcome.rss_before - outcome.rss_after) ||
                         !evaluator.mayBeRounding(outcome.predicted_decrease);
  if (!is_judged) return evaluator.cameCloser({}, outcome.predicted_decrease);
  if (has_fallen_back_ || evaluator.unknowns() < kLarge) return false;
  // The step is undone and redone, to save the values before it.
  evaluator.undo();
  best_ = std::make_unique<ValueSnapshot>(evaluator.problem());
  best_rss_ = outcome.rss_before;
  uphill_ = 1;
  evaluator.linearize();
  evaluator.tryLikelyStep(outcome.step);
  return true;
}

void SafeguardedGaussNewton::takeBack(Evaluator& evaluator) {
  if (best_ == nullptr) {
    evaluator.undo();
    return;
  }
  best_->restore();
  best_.reset();
}

void SafeguardedGaussNewton::finish(Evaluator& evaluator) {
  if (best_ != nullptr) takeBack(evaluator);
}

StepOutcome SafeguardedGaussNewton::step(Evaluator& evaluator, const Options& options) {
  int trials = 0;
  std::string event;
  if (is_newton_) {
    was_newton_ = true;
    StepOutcome outcome = newton_.step(evaluator, options);
    if (outcome.kind == StepOutcome::Kind::singular) {
      if (best_ == nullptr) return outcome;
      takeBack(evaluator);  // uphill steps led to a point without full rank
    } else {
      const bool is_taken = outcome.kind == StepOutcome::Kind::taken;
      const bool is_finite = is_taken && evaluator.hasFiniteDerivatives();
      if (is_finite && isAcceptable(evaluator, outcome)) return outcome;
      // The remaining RSS may be rounding errors. Then its growth means nothing.
      if (is_finite && best_ == nullptr &&
          (evaluator.isNearlyNothing(outcome.predicted_decrease, options) ||
           outcome.rss_before <= evaluator.roundingOfPromises())) {
        takeBack(evaluator);
        outcome.kind = StepOutcome::Kind::stuck;
        outcome.rss_after = outcome.rss_before;
        return outcome;
      }
      event = std::string("the Gauss-Newton step made ") +
              (is_finite  ? "the RSS grow"
               : is_taken ? "a derivative not finite"
                          : "a residual not finite") +
              "; the step was taken back, and Levenberg-Marquardt continued from there";
      if (is_taken || best_ != nullptr) takeBack(evaluator);
    }
    trials = outcome.trials;
    is_newton_ = false;
    good_steps_ = 0;
    patience_ = has_fallen_back_ ? std::min(2 * patience_, kMostPatience) : 1;
  }
  was_newton_ = false;
  StepOutcome outcome = damped_.step(evaluator, options);
  const bool is_good = outcome.kind == StepOutcome::Kind::taken && outcome.trials == 1 &&
                       outcome.rss_before - outcome.rss_after >= kGoodGain * outcome.predicted_decrease;
  good_steps_ = is_good ? good_steps_ + 1 : 0;
  is_newton_ = good_steps_ >= patience_;
  outcome.trials += trials;
  if (!has_fallen_back_) outcome.event = std::move(event);
  has_fallen_back_ = true;
  return outcome;
}

}  // namespace slom
