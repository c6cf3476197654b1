/// Confidence intervals of all parameters of a fit as a table.
///
///     std::cout << slom::intervals(est);            // text; .markdown() and .csv() for pages and programs
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom {

class Clustered;
class Estimator;

/// The interval of a component.
struct ParameterInterval {
  std::string name;
  double value = 0;               ///< as ParameterSummary::value
  double standard_deviation = 0;  ///< as ParameterSummary; 0 for a component at its bound
  double lower = 0, upper = 0;    ///< in the units of the value
  /// True: by profile likelihood, as slom::profile. False for components that are not coordinates, such as components
  /// of rotations: the interval is then the value +- the standard deviation times the normal or Student's quantile.
  bool is_profile = true;
};

/// Result of slom::intervals.
struct IntervalTable {
  double probability = 0.95;  ///< probability that an interval contains the true value
  std::vector<ParameterInterval> rows;

  /// Returns a table in columns for reading.
  std::string text() const;
  /// Returns a table in Markdown (GitHub's).
  std::string markdown() const;
  /// Returns lines `parameter,value,standard_deviation,lower,upper,method` with all digits, below that header; RFC
  /// 4180.
  std::string csv() const;
};

/// Prints text().
std::ostream& operator<<(std::ostream& os, const IntervalTable& table);

/// Returns the intervals of all unknowns, each as from slom::profile. Intervals of components that are not coordinates
/// come from their standard deviations. Throws as slom::profile does.
IntervalTable intervals(Estimator& est, double probability = 0.95);
/// Returns the intervals of all unknowns for errors that measurements share, as from slom::profile with `clustered`.
IntervalTable intervals(Estimator& est, const Clustered& clustered, double probability = 0.95);

}  // namespace slom
