/// Partitions of the measurements, which threads add up in parallel.
#pragma once

#include <vector>

#include "slom/linearize/jacobian_sink.hpp"
#include "slom/linearize/structure.hpp"

namespace slom {

/// Partitions the measurements into contiguous ranges of about the same work. Returns their first measurements, or
/// nothing if there is only one range. There are as many ranges as the limits on their size and on their private
/// accumulators allow. A partition needs private accumulators for each block of H that an earlier partition has added
/// to. The result depends only on the structure, not on the number of threads.
std::vector<MeasurementPlace> choosePartitions(const BlockStructure& structure);

/// Returns the partition of the measurement. The search begins at `partition`, which must not be behind it.
int partitionOf(const std::vector<MeasurementPlace>& partitions, int partition,
                const MeasurementPlace& measurement);

}  // namespace slom
