/// Partial minimum-degree elimination: blocks with few neighbours, as chains and trees of measurements have them. They are most of all blocks in
/// sparse graphs and are best eliminated one by one, before anything is ordered or put into fronts.
#pragma once

#include <vector>

#include "graph.hpp"

namespace slom {

/// What the elimination of some blocks leaves, and what it needs.
struct PartialMinimumDegree {
  std::vector<int> order;  ///< the eliminated blocks, in this order
  /// The neighbours of all blocks, in any order: those of an eliminated block at its elimination, those of the
  /// others at the end.
  BlockGraph filled;
  ReducedGraph left;
};

/// Eliminates blocks whose neighbours have at most kMostRowsBelow degrees of freedom together, those with the
/// fewest first, as long as there are some. They are taken in rounds of blocks that never meet, so that the
/// tree of elimination is shallow. Empty unless they are many, and not few of all blocks.
PartialMinimumDegree eliminateByMinimumDegree(const BlockGraph& graph);

/// Degrees of freedom of all neighbours of an eliminated block, and of itself, at most.
inline constexpr int kMostRowsBelow = 24, kMostColumns = 6;

}  // namespace slom
