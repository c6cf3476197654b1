/// Comparison of the derivatives that the library uses with differences, with a guess at the cause if they differ.
#pragma once

#include <iosfwd>
#include <limits>
#include <string>
#include <vector>

#include "slom/problem/problem.hpp"

namespace slom {

class Estimator;

/// The worst entry of the Jacobians of one group of measurements.
struct GroupDerivativeCheck {
  std::string group;        ///< label or type of the measurements
  DerivativeSource source;  ///< source of the derivatives that the library uses
  int measurements = 0;     ///< number of compared measurements
  std::string measurement;  ///< measurement with the worst entry
  int row = 0;              ///< row of the residual, from 0
  std::string component;    ///< name of the variable's component
  double used = 0;          ///< the entry as the library uses it
  double reference = 0;     ///< the entry by differences
  double error = 0;   ///< |used - reference| / largest entry of that variable's block in this measurement
  std::string guess;  ///< at the cause, a sentence; empty if the entries agree

  /// Returns a sentence such as `the given derivative of residual 0 of level #3 by x is -2, differences give 2: the
  /// sign is wrong`.
  std::string sentence() const;
};

struct DerivativeCheck {
  /// Largest error that counts as agreement. Differences of ordinary functions are accurate to about 8 digits.
  static constexpr double kTolerance = 1e-5;
  static constexpr double kDoubtful = 1e-3;  ///< error above which findWrongDerivatives reports

  std::vector<GroupDerivativeCheck> groups;  ///< groups with free variables

  /// Returns whether all groups agree.
  bool ok() const;
  /// Returns a line for each group, and a sentence for each group that does not agree.
  std::string text() const;
};

std::ostream& operator<<(std::ostream& os, const DerivativeCheck& check);

/// Compares the derivatives of all measurements at the current values with differences. Reports the worst entry of each
/// group by name and, if it is wrong, a guess at the cause. Slow; meant for development.
DerivativeCheck checkDerivatives(const Estimator& est);

/// Evaluates measurements at the current values and differentiates them by extrapolated central differences. Takes all
/// of them, or `most_of_group` of each group, spread evenly.
DerivativeCheck compareDerivatives(const Problem& problem,
                                   int most_of_group = std::numeric_limits<int>::max());

/// Returns the groups whose derivatives given by hand are certainly wrong, by a check of `most_of_group` measurements
/// of each group. The error must exceed kDoubtful, and 5 times the discrepancies among central, extrapolated and
/// one-sided differences. So a correct derivative passes in spite of noise, kinks, steps and ends of a function's
/// domain.
DerivativeCheck findWrongDerivatives(const Problem& problem, int most_of_group);

}  // namespace slom
