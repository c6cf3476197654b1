/// Tests of single residuals against the uncertainty of the fit.
#pragma once

#include "analyze/linearized_problem.hpp"
#include "slom/analyze/outliers.hpp"
#include "slom/analyze/uncertainty.hpp"

namespace slom {

/// Tests the residuals. `variance_factor` divides chi-squares. If it comes from the residuals, pass their `redundancy`,
/// otherwise 0. Throws the errors of LinearizedProblem::inverse.
OutlierReport checkResiduals(const LinearizedProblem& linearized, const OutlierOptions& options,
                             double variance_factor, int redundancy = 0, FreeGauge gauge = FreeGauge::error);

/// Tests the residuals of each group together, with the stated standard deviations: name, number, chi-square, redundancy
/// and p-value. Takes a fraction of the time of checkResiduals. Throws as it does.
std::vector<GroupCheck> checkGroups(const LinearizedProblem& linearized, FreeGauge gauge = FreeGauge::error);

/// Comparisons that order OutlierReport::ranking and GroupCheck::least_checkable.
bool lessProbable(const MeasurementCheck& a, const MeasurementCheck& b);
bool lessCheckable(const MeasurementCheck& a, const MeasurementCheck& b);

}  // namespace slom
