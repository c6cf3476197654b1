#pragma once

#include "slom/analyze/preflight.hpp"
#include "slom/optimize/system.hpp"

namespace slom {

/// Evaluates everything once, compares derivatives, counts residuals against unknowns, and diagnoses what is left.
Preflight preflight(System& system, Linearizer& linearizer);

}  // namespace slom
