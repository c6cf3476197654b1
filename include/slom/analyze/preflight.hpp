/// Preflight: a check of a problem before it is solved.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "slom/analyze/derivative_check.hpp"

namespace slom {

class Estimator;

/// The measurements with one label or of one type at the start values.
struct PreflightGroup {
  std::string name;
  int measurements = 0;
  int residuals = 0;
  double rss = 0;     ///< RSS of the measurements that could be evaluated
  std::string worst;  ///< the measurement with the longest whitened residual
  double worst_residual = 0;
};

/// Faults of a problem at its start values, and the contribution of each group of measurements.
struct Preflight {
  /// Reasons why the fit will fail or its result be wrong: a sentence each, with a remedy.
  std::vector<std::string> faults;
  std::vector<std::string> warnings;  ///< possible faults
  std::vector<PreflightGroup> groups;
  DerivativeCheck derivatives;  ///< of some measurements of each group

  /// Returns whether there are no faults; warnings do not count.
  bool ok() const { return faults.empty(); }
  /// Returns faults, warnings and a table of the groups.
  std::string text() const;
};

std::ostream& operator<<(std::ostream& os, const Preflight& preflight);

/// Checks the problem before solving. Evaluates every measurement once at the current values, compares derivatives of
/// some of each group, counts residuals, and diagnoses the rest. Faults are returned, not thrown.
Preflight preflight(const Estimator& est);

}  // namespace slom
