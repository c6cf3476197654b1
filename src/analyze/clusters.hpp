/// Measurements in groups whose errors are independent of each other.
#pragma once

#include <string>
#include <vector>

#include "slom/analyze/clustered.hpp"

namespace slom {

/// One way of grouping all measurements of a problem.
struct Clustering {
  std::string way;                        ///< `image`
  std::vector<std::vector<int>> of_pool;  ///< by pool and measurement: number of its group, -1 for none
  std::vector<std::string> names;         ///< by group; each has measurements
  int ungrouped = 0;                      ///< number of measurements without a group

  int count() const { return static_cast<int>(names.size()); }
};

/// The groups by number where keys are numbers, otherwise as they came first. Throws [slom.no-groups] or [slom.bad-group].
Clustering makeClustering(const Problem& problem, const ClusterBy& by);

/// Measurements that are in one group by both.
Clustering intersectionOf(const Clustering& a, const Clustering& b);

/// `length` successive groups are one; the last ones are as many as are left, and part of the block before where these are fewer than half.
Clustering blocksOf(const Clustering& clustering, int length);

}  // namespace slom
