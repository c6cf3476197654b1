/// Record of one step of an optimisation.
///
///     while (est.optimizeStep() > 1e-6) {}          // the relative gain, as published
///     const slom::StepRecord step = est.optimizeStep();
///     std::cout << step << "\n";
#pragma once

#include <iosfwd>

#include "slom/optimize/summary.hpp"

namespace slom {

/// Result of Estimator::optimizeStep(). It converts to the relative gain.
struct StepRecord {
  /// (old RSS - new RSS) / old RSS; negative if the step led uphill, 0 if the RSS was 0.
  double gain = 0;
  double rss_before = 0;
  double rss_after = 0;
  /// False if no tried step reduced the RSS; then the values are unchanged.
  bool is_accepted = false;
  int trials = 0;      ///< steps tried
  double damping = 0;  ///< Levenberg-Marquardt's mu, dog leg's radius; 0: none
  /// Number of directions in which the unknowns can move without changing a residual. 0 if the step solved an undamped
  /// system with a unique solution. After other steps they are counted at the new values, in problems with at most
  /// kMostUnknowns unknowns and kMostResiduals residuals. In larger problems the value is kNotCounted;
  /// slom::diagnose counts them.
  int free_directions = kNotCounted;
  double seconds = 0;   ///< time of the step, without counting free directions
  PhaseSeconds phases;  ///< parts of `seconds`

  static constexpr int kNotCounted = -1;
  static constexpr int kMostUnknowns = 100, kMostResiduals = 10'000;

  /// Returns the relative gain.
  operator double() const { return gain; }  // NOLINT(google-explicit-constructor): as published
};

/// Prints one line: the RSS before and after, whether the step was accepted, and the time of each phase.
std::ostream& operator<<(std::ostream& os, const StepRecord& step);

}  // namespace slom
