/// Confidence intervals of all parameters of a fit as a table.
///
///     std::cout << est.intervals();                 // text; .markdown() and .csv() for pages and programs
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// The interval of a component.
struct ParameterInterval {
  std::string name;
  double value = 0;               ///< as ParameterSummary::value
  double standard_deviation = 0;  ///< as ParameterSummary; 0 for a component at its bound
  double lower = 0, upper = 0;    ///< in the units of the value
  /// By profile likelihood, as Estimator::profile; false for components that are no coordinates, as those of rotations: then the
  /// value less and plus Student's or the normal quantile times the standard deviation.
  bool is_profile = true;
};

/// Returned by Estimator::intervals().
struct IntervalTable {
  double probability = 0.95;  ///< that an interval holds the true value
  std::vector<ParameterInterval> rows;

  /// Columns for the eye.
  std::string text() const;
  /// A table of Markdown (GitHub's).
  std::string markdown() const;
  /// Lines `parameter,value,standard_deviation,lower,upper,method` with all digits, below that header; RFC 4180.
  std::string csv() const;
};

/// text()
std::ostream& operator<<(std::ostream& os, const IntervalTable& table);

}  // namespace slom
