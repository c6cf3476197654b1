/// Options of a fit, checked.
#pragma once

#include "slom/optimize/summary.hpp"

namespace slom {

/// Throws [slom.bad-option], which names the option and its value.
void requireValid(const Options& options);

/// max_iterations or, for Options::kByTheSize, many where each is cheap.
int iterationLimit(const Options& options, int unknowns);

}  // namespace slom
