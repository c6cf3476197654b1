/// What can be said of a problem before it is solved.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "slom/analyze/derivative_check.hpp"

namespace slom {

/// What the start values make of the measurements with one label or of one type.
struct PreflightGroup {
  std::string name;
  int measurements = 0;
  int residuals = 0;
  double rss = 0;     ///< RSS of the measurements that could be evaluated
  std::string worst;  ///< the measurement with the longest whitened residual
  double worst_residual = 0;
};

/// What is wrong with a problem at its start values, and what each group of measurements contributes.
struct Preflight {
  std::vector<std::string>
      faults;  ///< the fit will fail or its result be wrong: a sentence each, with a remedy
  std::vector<std::string> warnings;  ///< worth a thought
  std::vector<PreflightGroup> groups;
  DerivativeCheck derivatives;  ///< for some measurements of each group

  /// Whether there are no faults; warnings do not count.
  bool ok() const { return faults.empty(); }
  /// Faults, warnings and a table of the groups.
  std::string text() const;
};

std::ostream& operator<<(std::ostream& os, const Preflight& preflight);

}  // namespace slom
