/// What each residual says of its measurement, given how sure the fit is.
#pragma once

#include "slom/analyze/outliers.hpp"
#include "slom/analyze/uncertainty.hpp"
#include "slom/optimize/system.hpp"

namespace slom {

/// Throws what inverseBlocks throws. `variance_factor` divides chi-squares.
OutlierReport checkResiduals(System& system, Linearizer& linearizer, const OutlierOptions& options,
                             double variance_factor, FreeGauge gauge = FreeGauge::error);

}  // namespace slom
