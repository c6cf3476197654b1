/// When a fit has converged. All tests look at what the linear model promises without damping: that a short
/// step was refused, or promises little, says nothing.
#pragma once

#include <optional>

#include "problem/stated_noise.hpp"
#include "slom/optimize/algorithm.hpp"
#include "slom/optimize/system.hpp"

namespace slom {

class Convergence {
 public:
  Convergence(System& system, const Options& options, bool sigma_is_estimated)
      : system_(system),
        options_(options),
        sigma_is_estimated_(sigma_is_estimated),
        is_stated_(statesAllNoise(system.problem())) {}

  /// Tells it the RSS of the start.
  void begin(double rss) { first_rss_ = rss; }
  /// Behind a step that was taken from where the gradient's cosine was `gradient`.
  std::optional<StopReason> afterStep(const StepOutcome& outcome, double gradient, double decrease_tolerance);
  /// Where no step was taken.
  /// `has_rank`: not where the algorithm has found none; there the gradient alone tells.
  std::optional<StopReason> whenStuck(double gradient, double decrease_tolerance, bool has_rank = true);
  /// Whether what is promised where no step helps, even from a fresh start of the algorithm, is hidden by
  /// rounding errors of the RSS and small beside a standard deviation.
  bool isHidden();
  /// Whether whenStuck has found no reason to stop but a step of its own, and taken it.
  bool hasAdvanced() const { return has_advanced_; }

 private:
  double variance(double rss) const;
  bool isNear(double promised, double rss) const;
  bool isRounding(double promised, double rss);
  System::Promise promiseAt(double rss, bool carefully);

  System& system_;
  const Options& options_;
  bool sigma_is_estimated_, is_stated_;
  double first_rss_ = 0;
  int candidates_ = 0;  // since the last step that was none
  bool has_advanced_ = false;
};

}  // namespace slom
