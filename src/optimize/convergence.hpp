/// Convergence of a fit. All tests use the decrease that the linear model predicts without damping. A short step that
/// was refused, or that predicts a small decrease, proves nothing.
#pragma once

#include <limits>
#include <optional>

#include "problem/stated_noise.hpp"
#include "slom/optimize/algorithm.hpp"
#include "slom/optimize/evaluator.hpp"

namespace slom {

class Convergence {
 public:
  Convergence(Evaluator& evaluator, const Options& options, bool sigma_is_estimated)
      : evaluator_(evaluator),
        options_(options),
        sigma_is_estimated_(sigma_is_estimated),
        is_stated_(evaluator.collective().all(statesAllNoise(evaluator.problem()))) {}

  /// Begins a fit whose start has this `rss`.
  void begin(double rss) { first_rss_ = rss; }
  /// Tests for convergence after a step. `gradient` is Evaluator::orthogonality() before the step.
  std::optional<StopReason> afterStep(const StepOutcome& outcome, double gradient, double decrease_tolerance);
  /// Returns whether many successive steps changed the RSS only by rounding and the predicted decrease hardly. Call it
  /// after each step that was taken, except the last.
  bool creeps(const StepOutcome& outcome);
  /// Tests for convergence if no step was taken. If the algorithm found no full rank (`has_rank` false), only the
  /// gradient decides.
  std::optional<StopReason> whenStuck(double gradient, double decrease_tolerance, bool has_rank = true);
  /// Returns whether the predicted decrease is hidden by rounding errors of the RSS and small compared with a standard
  /// deviation. Call it if no step helps, even from a fresh start of the algorithm.
  bool isHidden();
  /// Returns whether whenStuck() found no reason to stop, but took a step of its own.
  bool hasAdvanced() const { return has_advanced_; }

 private:
  double variance(double rss) const;
  /// Returns the largest promise at which the end is near.
  double mostNear(double rss) const;
  bool isNear(double promised, double rss) const;
  bool isRounding(double promised, double rss);
  Evaluator::Promise promiseAt(double rss, bool carefully,
                               double most = std::numeric_limits<double>::infinity());

  Evaluator& evaluator_;
  const Options& options_;
  bool sigma_is_estimated_, is_stated_;
  double first_rss_ = 0;
  int candidates_ = 0;    // since the last step that was no candidate
  int hidden_steps_ = 0;  // successive steps that changed the RSS by rounding alone
  double hidden_promise_ = std::numeric_limits<double>::infinity();  // at the last look, some such steps ago
  bool has_advanced_ = false;
};

}  // namespace slom
