/// What the robust losses do to the measurements at the current values.
#pragma once

#include <string>
#include <vector>

#include "slom/optimize/summary.hpp"
#include "slom/problem/measurement_pool.hpp"

namespace slom {

/// An entry for each different loss of the pool's measurements; the pool is evaluated, unless none has a loss.
std::vector<LossSummary> summarizeLosses(MeasurementPool& pool);

/// Adds the entries of `more`, of another pool of the same group, to `sum`.
void addLosses(const std::vector<LossSummary>& more, std::vector<LossSummary>& sum);

/// A sentence for each loss that gives measurements the weight 0, so that nothing is determined by them.
std::vector<std::string> weightlessMeasurements(const std::vector<GroupSummary>& groups);

}  // namespace slom
