/// What one step of an optimisation did.
///
///     while (est.optimizeStep() > 1e-6) {}          // the relative gain, as published
///     const slom::StepRecord step = est.optimizeStep();
///     std::cout << step << "\n";
#pragma once

#include <iosfwd>

#include "slom/optimize/summary.hpp"

namespace slom {

/// Returned by Estimator::optimizeStep(). It converts to the relative gain.
struct StepRecord {
  double gain =
      0;  ///< (old RSS - new RSS) / old RSS; negative when the step led uphill, 0 where the RSS was 0
  double rss_before = 0;
  double rss_after = 0;
  bool is_accepted =
      false;           ///< false: no step that was tried made the RSS smaller, and the values are as before
  int trials = 0;      ///< steps tried
  double damping = 0;  ///< Levenberg-Marquardt's mu, dog leg's radius; 0: none
  /// Directions in which the unknowns can move without changing a residual. 0 where the step was that of an undamped system with one
  /// solution. After others they are counted, at the values that the step has led to, in problems with at most kMostUnknowns unknowns
  /// and kMostResiduals residuals, for larger ones by Estimator::diagnose(). kNotCounted: not counted.
  int free_directions = kNotCounted;
  double seconds = 0;   ///< of the step; without counting free directions
  PhaseSeconds phases;  ///< parts of `seconds`

  static constexpr int kNotCounted = -1;
  static constexpr int kMostUnknowns = 100, kMostResiduals = 10'000;

  /// The relative gain.
  operator double() const { return gain; }  // NOLINT(google-explicit-constructor): as published
};

/// One line: what the RSS was and is, whether the step was accepted, and where its time went.
std::ostream& operator<<(std::ostream& os, const StepRecord& step);

}  // namespace slom
