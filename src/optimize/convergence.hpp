/// When a fit has converged. All tests look at the decrease that the linear model predicts without damping: a short step that
/// was refused, or whose predicted decrease is small, says nothing.
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
        is_stated_(statesAllNoise(evaluator.problem())) {}

  /// `rss` is that of the start.
  void begin(double rss) { first_rss_ = rss; }
  /// The test after a step that was taken from where Evaluator::orthogonality() was `gradient`.
  std::optional<StopReason> afterStep(const StepOutcome& outcome, double gradient, double decrease_tolerance);
  /// Whether many successive steps have changed the RSS only by rounding, and the predicted decrease hardly. To be called after each
  /// step that was taken and is not the last.
  bool creeps(const StepOutcome& outcome);
  /// The test where no step was taken. Without `has_rank`, as the algorithm has found it, only the gradient decides.
  std::optional<StopReason> whenStuck(double gradient, double decrease_tolerance, bool has_rank = true);
  /// Whether the decrease that is predicted where no step helps, even from a fresh start of the algorithm, is hidden by
  /// rounding errors of the RSS and small beside a standard deviation.
  bool isHidden();
  /// Whether whenStuck has found no reason to stop but a step of its own, and taken it.
  bool hasAdvanced() const { return has_advanced_; }

 private:
  double variance(double rss) const;
  /// The largest promise at which the end is near.
  double mostNear(double rss) const;
  bool isNear(double promised, double rss) const;
  bool isRounding(double promised, double rss);
  Evaluator::Promise promiseAt(double rss, bool carefully,
                               double most = std::numeric_limits<double>::infinity());

  Evaluator& evaluator_;
  const Options& options_;
  bool sigma_is_estimated_, is_stated_;
  double first_rss_ = 0;
  int candidates_ = 0;    // since the last step that was none
  int hidden_steps_ = 0;  // that changed the RSS by rounding alone, one after the other
  double hidden_promise_ =
      std::numeric_limits<double>::infinity();  // when last looked at, some such steps ago
  bool has_advanced_ = false;
};

}  // namespace slom
