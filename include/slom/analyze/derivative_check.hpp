/// Compares the derivatives that the library uses with differences, and guesses what is wrong where they differ.
#pragma once

#include <iosfwd>
#include <limits>
#include <string>
#include <vector>

#include "slom/problem/problem.hpp"

namespace slom {

/// The worst entry of the Jacobians of one group of measurements.
struct GroupDerivativeCheck {
  std::string group;        ///< label or type of the measurements
  DerivativeSource source;  ///< what the library uses
  int measurements = 0;     ///< compared ones
  std::string measurement;  ///< that holds the worst entry
  int row = 0;              ///< row of the residual, from 0
  std::string component;    ///< name of the variable's component
  double used = 0;          ///< the entry as the library uses it
  double reference = 0;     ///< the entry by differences
  double error = 0;   ///< |used - reference| / largest entry of that variable's block in this measurement
  std::string guess;  ///< at the cause, a sentence; empty when the entries agree

  /// `the given derivative of residual 0 of level #3 by x is -2, differences give 2: the sign is wrong`
  std::string sentence() const;
};

struct DerivativeCheck {
  /// Differences of functions of ordinary size are right to about eight digits.
  static constexpr double kTolerance = 1e-5;
  static constexpr double kDoubtful = 1e-3;  ///< what findWrongDerivatives reports

  std::vector<GroupDerivativeCheck> groups;  ///< those that have free variables

  /// Whether all groups agree.
  bool ok() const;
  /// A line for each group, and a sentence for each that does not agree.
  std::string text() const;
};

std::ostream& operator<<(std::ostream& os, const DerivativeCheck& check);

/// Evaluates measurements at the current values and differentiates them by extrapolated central differences: all, or
/// `most_of_group` of each group, spread over it evenly.
DerivativeCheck compareDerivatives(const Problem& problem,
                                   int most_of_group = std::numeric_limits<int>::max());

/// The groups whose derivatives are given by hand and are wrong beyond doubt, looking at `most_of_group` measurements of each: by
/// more than kDoubtful, and by more than five times what central, extrapolated and one-sided differences differ among themselves. So neither noise
/// nor kinks, steps and ends of a function's domain make a good derivative look wrong.
DerivativeCheck findWrongDerivatives(const Problem& problem, int most_of_group);

}  // namespace slom
