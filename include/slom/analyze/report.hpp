/// A fit as text.
#pragma once

#include <iosfwd>
#include <string>

#include "slom/optimize/summary.hpp"

namespace slom {

/// Some lines to read at a glance: what was fitted, whether it converged and why it stopped, RSS before and after
/// for each type of measurement, warnings.
std::string report(const Summary& summary);
std::ostream& operator<<(std::ostream& os, const Summary& summary);

/// An observer that prints a table to `os`, a line for each iteration. `os` must outlive the fit.
Observer progressTable(std::ostream& os);

}  // namespace slom
