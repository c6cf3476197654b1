/// What the robust losses do to the measurements at the current values.
#pragma once

#include <string>
#include <vector>

#include "slom/optimize/summary.hpp"
#include "slom/problem/measurement_pool.hpp"

namespace slom {

/// An entry for each different loss of the pool's measurements; the pool is evaluated, unless none has a loss.
std::vector<LossSummary> summarizeLosses(MeasurementPool& pool);

/// A sentence for each loss that gives measurements the weight 0, so that nothing is determined by them.
std::vector<std::string> weightlessMeasurements(const std::vector<GroupSummary>& groups);

}  // namespace slom
