/// Graduated non-convexity: stages of a fit with losses of larger scale, as Options::graduated_non_convexity says.
#pragma once

#include "slom/optimize/evaluator.hpp"

namespace slom {

/// The stages, mu falling to 1. In addition to the schedule of Yang and others 2020, mu never stays above what its first value's rule
/// gives for the present residuals, so that a start far away does not cost stages once the first fits have come near. The losses have
/// their own scale again when it goes.
class Graduation {
 public:
  Graduation(Evaluator& evaluator, const Options& options);
  ~Graduation();
  Graduation(const Graduation&) = delete;
  Graduation& operator=(const Graduation&) = delete;

  /// Whether any measurement has a loss.
  bool hasLosses() const { return most_ >= 0; }
  /// The next stage: scales the losses.
  void advance();
  bool isLast() const { return mu_ == 1; }
  /// The options of this stage, which begins after `iterations` of at most `most`.
  Options limits(int iterations, int most) const;

 private:
  Evaluator& evaluator_;
  const Options& options_;
  double mu_ = 0;  // 0: no stage yet
  double most_;
};

}  // namespace slom
