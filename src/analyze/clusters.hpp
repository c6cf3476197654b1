/// Measurements in groups. The errors of different groups are independent.
#pragma once

#include <string>
#include <vector>

#include "slom/analyze/clustered.hpp"

namespace slom {

/// One way of grouping all measurements of a problem.
struct Clustering {
  std::string way;                        ///< `image`
  std::vector<std::vector<int>> of_pool;  ///< by pool and measurement: number of its group; -1: no group
  std::vector<std::string> names;         ///< by group; each group has measurements
  int ungrouped = 0;                      ///< number of measurements without a group

  int count() const { return static_cast<int>(names.size()); }
};

/// Groups all measurements. If keys are numbers, groups are sorted by key, otherwise by first occurrence. Throws
/// [slom.no-groups] or [slom.bad-group].
Clustering makeClustering(const Problem& problem, const ClusterBy& by);

/// Groups measurements that share a group in a and in b.
Clustering intersectionOf(const Clustering& a, const Clustering& b);

/// Joins each `length` successive groups. If fewer than half of `length` groups are left at the end, they join the last
/// block; otherwise they form a block.
Clustering blocksOf(const Clustering& clustering, int length);

}  // namespace slom
