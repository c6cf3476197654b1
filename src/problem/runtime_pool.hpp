/// Measurements of one run-time kind and one arity. Each measurement has its own variable types and residual length.
/// The linearisation and the solvers read the variables of a pool as rows of a table with `arity` columns. So a pool
/// has one arity, and a kind has a pool for each arity that occurs. A table padded to the largest arity would need
/// fewer pools. But a solver's storage grows with the square of the arity, so one prior over 500 variables would make
/// every other measurement of its kind as expensive. Typed pools are not affected: their arity is part of their type.
#pragma once

#include "slom/model/runtime_measurement.hpp"
#include "slom/problem/measurement_pool.hpp"

namespace slom {

using OwnedMeasurement = std::unique_ptr<RuntimeMeasurement>;

/// Returns the type of pools of this kind and arity. Its `dof` has no entries: the table of variables holds degrees of
/// freedom.
MeasurementType runtimeType(const RuntimeKind& kind, int arity);

}  // namespace slom
