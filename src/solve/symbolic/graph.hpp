/// The graph of blocks: an edge between any two that meet in a measurement.
#pragma once

#include <vector>

#include "slom/linearize/structure.hpp"

namespace slom {

struct BlockGraph {
  std::vector<int> start;      ///< first neighbour of each block; one more entry for the end
  std::vector<int> neighbour;  ///< ascending, each once, without the block itself
  std::vector<int> dof;        ///< degrees of freedom of each block

  int size() const { return static_cast<int>(dof.size()); }
  bool operator==(const BlockGraph&) const = default;
};

BlockGraph makeGraph(const BlockStructure& structure);

/// The graph of the blocks that are left when others have been eliminated; two are neighbours if they were, or if both
/// had an eliminated one as neighbour.
struct ReducedGraph {
  BlockGraph graph;
  std::vector<int> block;  ///< block of the full graph that each node is; ascending
};

}  // namespace slom
