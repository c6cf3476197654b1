/// Small blocks that never meet each other, such as points seen by cameras. All of them can be eliminated
/// independently.
#pragma once

#include <vector>

#include "graph.hpp"

namespace slom {

/// Largest number of degrees of freedom of such a block.
inline constexpr int kLargestIndependent = 3;

/// Returns, by block, whether it is such a block. Blocks with few neighbours are taken first. Empty unless most blocks
/// are such blocks.
std::vector<char> independentBlocks(const BlockGraph& graph);

/// Returns the graph without the eliminated blocks, of which no two meet.
ReducedGraph reduceGraph(const BlockGraph& graph, const std::vector<char>& eliminated);

}  // namespace slom
