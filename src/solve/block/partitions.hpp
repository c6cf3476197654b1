/// Partitions of the measurements, which threads add up side by side.
#pragma once

#include <vector>

#include "slom/linearize/jacobian_sink.hpp"
#include "slom/linearize/structure.hpp"

namespace slom {

/// Partitions the measurements into contiguous ranges of about the same work; returns where they begin. As many of them as the limits on
/// their size and on their private accumulators allow; none where that is one. A partition needs private accumulators for each block of H
/// that an earlier partition has added to. The result depends on the structure alone, not on the number of threads.
std::vector<MeasurementPlace> choosePartitions(const BlockStructure& structure);

/// The partition that the measurement is in, which is not before `partition`.
int partitionOf(const std::vector<MeasurementPlace>& partitions, int partition,
                const MeasurementPlace& measurement);

}  // namespace slom
