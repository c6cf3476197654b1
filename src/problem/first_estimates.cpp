/// First estimates of a problem's variables. Priors bring them; removing the last such prior removes them.
#include "base/index.hpp"
#include "slom/model/runtime_measurement.hpp"
#include "slom/problem/problem.hpp"

namespace slom {

namespace {
/// Returns the first estimate that a measurement brings for a variable; null: none.
const void* firstEstimateOf(const RuntimeMeasurement& measurement, const int* variables, int variable) {
  for (int k = 0; k < measurement.arity(); ++k) {
    if (variables[k] == variable) return measurement.firstEstimate(k);
  }
  return nullptr;
}
}  // namespace

void FirstEstimates::makeRoom(std::size_t variables) {
  if (points_.size() < variables) points_.resize(variables, nullptr);
}

const void* Problem::linearizationPoint(int variable) const {
  if (const void* const point = first_estimates_.of(variable); point != nullptr) return point;
  const VariableRecord& record = table_[at(variable)];
  return record.store->valueAt(record.slot);
}

/// Sets a first estimate. This counts as a move of the variable, because it changes the Jacobians of its measurements.
void Problem::setFirstEstimate(int variable, const void* point) {
  first_estimates_.set(variable, point);
  moves_.add(variable, size());
}

/// Takes the measurement's first estimates of variables that have none yet.
void Problem::takeFirstEstimates(const RuntimeMeasurement& measurement, const int* variables) {
  for (int k = 0; k < measurement.arity(); ++k) {
    const void* const point = measurement.firstEstimate(k);
    if (point != nullptr && first_estimates_.of(variables[k]) == nullptr)
      setFirstEstimate(variables[k], point);
  }
}

/// Removes the first estimates that this measurement brought. If remaining measurements bring others, the one inserted
/// first in the first pool replaces it.
void Problem::dropFirstEstimates(const RuntimeMeasurement& measurement, const int* variables) {
  for (int k = 0; k < measurement.arity(); ++k) {
    const int variable = variables[k];
    const void* const own = measurement.firstEstimate(k);
    if (own == nullptr || first_estimates_.of(variable) != own) continue;
    const void* next = nullptr;
    std::pair<int, long> earliest;
    forEachUse(variable, [&](const MeasurementPool& pool, int i) {
      const RuntimeMeasurement* const other = pool.runtimeMeasurement(i);
      if (other == nullptr || other == &measurement) return;
      const void* const point = firstEstimateOf(*other, pool.variables(i), variable);
      const std::pair place(pool.index(), pool.serial(i));
      if (point == nullptr || (next != nullptr && !(place < earliest))) return;
      next = point;
      earliest = place;
    });
    setFirstEstimate(variable, next);
  }
}

}  // namespace slom
