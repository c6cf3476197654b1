/// Graduated non-convexity: stages of a fit with losses of larger scale, see Options::graduated_non_convexity.
#pragma once

#include "slom/optimize/evaluator.hpp"

namespace slom {

/// The stages, with mu falling to 1. In addition to the schedule of Yang and others 2020, mu never exceeds the value
/// that the rule for its first value gives for the present residuals. So a distant start costs no more stages once the
/// first fits are near. The destructor gives the losses their own scale again.
class Graduation {
 public:
  Graduation(Evaluator& evaluator, const Options& options);
  ~Graduation();
  Graduation(const Graduation&) = delete;
  Graduation& operator=(const Graduation&) = delete;

  /// Returns whether any measurement has a loss.
  bool hasLosses() const { return most_ >= 0; }
  /// Begins the next stage: scales the losses.
  void advance();
  bool isLast() const { return mu_ == 1; }
  /// Returns the options of this stage, which begins after `iterations` of at most `most`.
  Options limits(int iterations, int most) const;

 private:
  Evaluator& evaluator_;
  const Options& options_;
  double mu_ = 0;  // 0: before the first stage
  double most_;
};

}  // namespace slom
