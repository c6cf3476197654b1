/// What each residual says of its measurement, given how sure the fit is.
#pragma once

#include "analyze/linearized_problem.hpp"
#include "slom/analyze/outliers.hpp"
#include "slom/analyze/uncertainty.hpp"

namespace slom {

/// Throws what LinearizedProblem::inverse throws. `variance_factor` divides chi-squares; where it comes from the residuals, `redundancy` is
/// theirs, otherwise 0.
OutlierReport checkResiduals(const LinearizedProblem& linearized, const OutlierOptions& options,
                             double variance_factor, int redundancy = 0, FreeGauge gauge = FreeGauge::error);

/// The orders of OutlierReport::ranking and of GroupCheck::least_checkable.
bool lessProbable(const MeasurementCheck& a, const MeasurementCheck& b);
bool lessCheckable(const MeasurementCheck& a, const MeasurementCheck& b);

}  // namespace slom
