/// A fit as text.
#pragma once

#include <iosfwd>
#include <string>

#include "slom/optimize/summary.hpp"

namespace slom {

/// Returns a short report: what was fitted, whether and why it stopped or converged, the RSS before and after for each
/// type of measurement, and warnings.
std::string report(const Summary& summary);
std::ostream& operator<<(std::ostream& os, const Summary& summary);

/// Returns an observer that prints a table to `os`, one line for each iteration. `os` must outlive the fit.
Observer progressTable(std::ostream& os);

}  // namespace slom
