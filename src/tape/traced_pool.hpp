/// The measurements of a pool with one tape.
#pragma once

#include "slom/problem/measurement_pool.hpp"
#include "slom/tape/measurement.hpp"

namespace slom {

/// Returns the kind of a pool's measurements; null if they are not traced.
const TracedKind* tracedKindOf(const MeasurementPool& pool);
/// Returns the data of measurement i of such a pool: as many numbers as its tape has columns.
const double* tracedDataOf(const MeasurementPool& pool, int i);

}  // namespace slom
