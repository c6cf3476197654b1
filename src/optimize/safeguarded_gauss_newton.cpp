#include "optimize/safeguarded_gauss_newton.hpp"

#include <algorithm>
#include <cmath>

#include "slom/optimize/system.hpp"

namespace slom {

namespace {
constexpr int kLarge = 60;       // unknowns
constexpr int kUphillSteps = 2;  // one after the other, in large problems
constexpr int kMostPatience = 16;
constexpr double kGoodGain = 0.75;  // actual / predicted decrease
}  // namespace

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

/// Whether the step stays. Where rounding hides the change of the RSS, the predicted decrease decides.
bool SafeguardedGaussNewton::isAcceptable(System& system, const StepOutcome& outcome) {
  if (best_ != nullptr) {
    if (outcome.rss_after < best_rss_) {
      best_.reset();
      return true;
    }
    return ++uphill_ <= kUphillSteps;
  }
  if (outcome.rss_after <= outcome.rss_before) return true;
  const bool is_judged = !system.mayBeRounding(outcome.rss_before - outcome.rss_after) ||
                         !system.mayBeRounding(outcome.predicted_decrease);
  if (!is_judged) return system.cameCloser({}, outcome.predicted_decrease);
  if (has_fallen_back_ || system.structure().system.unknowns() < kLarge) return false;
  // Back for a moment: the values before the step are those to return to.
  system.undo();
  best_ = std::make_unique<ValueSnapshot>(system.problem());
  best_rss_ = outcome.rss_before;
  uphill_ = 1;
  system.linearize();
  system.tryLikelyStep(outcome.step);
  return true;
}

void SafeguardedGaussNewton::takeBack(System& system) {
  if (best_ == nullptr) {
    system.undo();
    return;
  }
  best_->restore();
  best_.reset();
}

void SafeguardedGaussNewton::finish(System& system) {
  if (best_ != nullptr) takeBack(system);
}

StepOutcome SafeguardedGaussNewton::step(System& system, const Options& options) {
  int trials = 0;
  std::string event;
  if (is_newton_) {
    was_newton_ = true;
    StepOutcome outcome = newton_.step(system, options);
    if (outcome.kind == StepOutcome::Kind::singular) {
      if (best_ == nullptr) return outcome;
      takeBack(system);  // uphill, to where the rank is missing
    } else {
      const bool is_finite = outcome.kind == StepOutcome::Kind::taken;
      if (is_finite && isAcceptable(system, outcome)) return outcome;
      if (is_finite && best_ == nullptr && system.isNearlyNothing(outcome.predicted_decrease, options)) {
        takeBack(system);
        outcome.kind = StepOutcome::Kind::stuck;
        outcome.rss_after = outcome.rss_before;
        return outcome;
      }
      event = std::string("the Gauss-Newton step made ") +
              (is_finite ? "the RSS grow" : "a residual not finite") +
              "; it was taken back and Levenberg-Marquardt went on from there";
      if (is_finite || best_ != nullptr) takeBack(system);
    }
    trials = outcome.trials;
    is_newton_ = false;
    good_steps_ = 0;
    patience_ = has_fallen_back_ ? std::min(2 * patience_, kMostPatience) : 1;
  }
  was_newton_ = false;
  StepOutcome outcome = damped_.step(system, options);
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
