/// Measurements of one run-time kind and one arity; variable types and lengths of residuals are each measurement's own.
/// A pool has one arity, and kinds have a pool for each arity that occurs, because the linearisation and the solvers read the
/// variables of a pool as rows of a table with `arity` columns. A table padded to the largest arity would do without more pools;
/// but what a solver keeps grows with the square of the arity, so that one prior over 500 variables would make every other
/// measurement of its kind as expensive. Typed pools are not touched by any of this: their arity stays part of their type.
#pragma once

#include "slom/model/runtime_measurement.hpp"
#include "slom/problem/measurement_pool.hpp"

namespace slom {

using OwnedMeasurement = std::unique_ptr<RuntimeMeasurement>;

/// The type of pools of this kind and arity. Its `dof` has no entries: degrees of freedom are known to the table of variables.
MeasurementType runtimeType(const RuntimeKind& kind, int arity);

}  // namespace slom
