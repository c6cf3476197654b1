/// What can be said of a problem before it is solved.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "slom/analyze/derivative_check.hpp"

namespace slom {

struct PreflightGroup {
  std::string name;
  int measurements = 0;
  int residuals = 0;
  double rss = 0;     ///< RSS of the measurements that could be evaluated
  std::string worst;  ///< the measurement with the longest whitened residual
  double worst_residual = 0;
};

struct Preflight {
  std::vector<std::string>
      faults;  ///< the fit will fail or its result be wrong: a sentence each, with a remedy
  std::vector<std::string> warnings;  ///< worth a thought
  std::vector<PreflightGroup> groups;
  DerivativeCheck derivatives;  ///< for some measurements of each group

  bool ok() const { return faults.empty(); }
  std::string text() const;
};

std::ostream& operator<<(std::ostream& os, const Preflight& preflight);

}  // namespace slom
