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
  int row = 0;              ///< of the residual, from 0
  std::string component;    ///< of a variable, by name
  double used = 0;          ///< the entry as the library uses it
  double reference = 0;     ///< the entry by differences
  double error = 0;         ///< |used - reference| / largest entry of that variable's block in this measurement
  std::string guess;        ///< at the cause, a sentence; empty when the entries agree
};

struct DerivativeCheck {
  /// Differences of functions of ordinary size are right to about eight digits.
  static constexpr double kTolerance = 1e-5;

  std::vector<GroupDerivativeCheck> groups;  ///< those that have free variables

  /// Whether all groups agree.
  bool ok() const;
  /// A line for each group, and a sentence for each that does not agree.
  std::string text() const;
};

std::ostream& operator<<(std::ostream& os, const DerivativeCheck& check);

/// Evaluates measurements at the current values and differentiates them by extrapolated central differences: all, or so many of
/// each group, spread over it evenly.
DerivativeCheck compareDerivatives(Problem& problem, int most_of_group = std::numeric_limits<int>::max());

}  // namespace slom
