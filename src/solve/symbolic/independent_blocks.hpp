/// Small blocks that never meet each other, as points do that cameras see. They can all be eliminated at once, each by itself.
#pragma once

#include <vector>

#include "graph.hpp"

namespace slom {

/// Degrees of freedom of a block, at most.
inline constexpr int kLargestIndependent = 3;

/// Whether each block is one of them; blocks with few neighbours are taken before others. Empty unless they are most of all
/// blocks.
std::vector<char> independentBlocks(const BlockGraph& graph);

/// What is left without the eliminated blocks, of which no two meet.
ReducedGraph reduceGraph(const BlockGraph& graph, const std::vector<char>& eliminated);

}  // namespace slom
