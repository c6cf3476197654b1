/// Effect of the robust losses on the measurements at the current values.
#pragma once

#include <string>
#include <vector>

#include "slom/optimize/summary.hpp"
#include "slom/problem/measurement_pool.hpp"

namespace slom {

/// Returns an entry for each different loss of the pool's measurements. Evaluates the pool unless none of them has a
/// loss.
std::vector<LossSummary> summarizeLosses(MeasurementPool& pool);

/// Adds the entries of `more`, from another pool of the same group, to `sum`.
void addLosses(const std::vector<LossSummary>& more, std::vector<LossSummary>& sum);

/// Returns a sentence for each loss that gives measurements the weight 0, so that they determine nothing.
std::vector<std::string> weightlessMeasurements(const std::vector<GroupSummary>& groups);

}  // namespace slom
