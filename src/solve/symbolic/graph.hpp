/// The graph of blocks, with an edge between any two that meet in a measurement.
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

/// The graph of the blocks that remain after others are eliminated. Two blocks are neighbours if they were before, or
/// if both were neighbours of an eliminated block.
struct ReducedGraph {
  BlockGraph graph;
  std::vector<int> block;  ///< by node: its block of the full graph, ascending
};

}  // namespace slom
