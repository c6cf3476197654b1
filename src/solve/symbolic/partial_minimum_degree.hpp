/// Partial minimum-degree elimination of blocks with few neighbours, which occur in chains and trees of measurements.
/// In sparse graphs they are most of all blocks. They are best eliminated one by one, before anything is ordered or put
/// into fronts.
#pragma once

#include <vector>

#include "graph.hpp"

namespace slom {

/// Result of the elimination of some blocks.
struct PartialMinimumDegree {
  std::vector<int> order;  ///< the eliminated blocks, in this order
  /// Neighbours of all blocks, in any order: those of an eliminated block at its elimination, those of the others at
  /// the end.
  BlockGraph filled;
  ReducedGraph left;
};

/// Eliminates blocks whose neighbours have at most kMostRowsBelow degrees of freedom in total, the blocks with the
/// fewest first, as long as there are any. Each round takes blocks that never meet, so that the tree of elimination is
/// shallow. Empty unless the blocks are many, and not a small fraction of all blocks.
PartialMinimumDegree eliminateByMinimumDegree(const BlockGraph& graph);

/// Largest number of degrees of freedom of all neighbours of an eliminated block, and of the block itself.
inline constexpr int kMostRowsBelow = 24, kMostColumns = 6;

}  // namespace slom
