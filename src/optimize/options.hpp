/// Options of a fit, checked.
#pragma once

#include "slom/optimize/summary.hpp"

namespace slom {

/// Throws [slom.bad-option] with the option and its value unless the options are valid.
void requireValid(const Options& options);

/// Returns max_iterations or, for Options::kByTheSize, a limit that is large if iterations are cheap.
int iterationLimit(const Options& options, int unknowns);

}  // namespace slom
