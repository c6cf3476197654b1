#include "independent_blocks.hpp"

#include <algorithm>

#include "base/index.hpp"

namespace slom {

namespace {

/// Number of independent blocks below which the ordering handles them.
constexpr int kFewestEliminated = 64;
/// Fraction of all blocks below which independent blocks do not count: graphs without such a structure, such as paths,
/// have fewer.
constexpr double kLeastShare = 2.0 / 3;

}  // namespace

std::vector<char> independentBlocks(const BlockGraph& graph) {
  const auto degree = [&](int b) { return graph.start[at(b) + 1] - graph.start[at(b)]; };
  std::vector<int> candidates;
  for (int b = 0; b < graph.size(); ++b) {
    if (graph.dof[at(b)] <= kLargestIndependent) candidates.push_back(b);
  }
  if (static_cast<int>(candidates.size()) < kFewestEliminated) return {};
  std::stable_sort(candidates.begin(), candidates.end(), [&](int a, int b) { return degree(a) < degree(b); });
  std::vector<char> eliminated(at(graph.size()), 0);
  int count = 0;
  for (const int b : candidates) {
    const auto first = graph.neighbour.begin() + graph.start[at(b)];
    if (std::any_of(first, first + degree(b), [&](int c) { return eliminated[at(c)] != 0; })) continue;
    eliminated[at(b)] = 1;
    ++count;
  }
  if (count < kFewestEliminated || count < kLeastShare * graph.size()) return {};
  return eliminated;
}

ReducedGraph reduceGraph(const BlockGraph& graph, const std::vector<char>& eliminated) {
  ReducedGraph result;
  std::vector<int> node(at(graph.size()), -1), mark;
  for (int b = 0; b < graph.size(); ++b) {
    if (eliminated[at(b)]) continue;
    node[at(b)] = static_cast<int>(result.block.size());
    result.block.push_back(b);
    result.graph.dof.push_back(graph.dof[at(b)]);
  }
  mark.assign(result.block.size(), -1);
  result.graph.start.push_back(0);
  std::vector<int>& neighbour = result.graph.neighbour;
  for (int i = 0; i < static_cast<int>(result.block.size()); ++i) {
    const int b = result.block[at(i)];
    const std::size_t first = neighbour.size();
    mark[at(i)] = i;
    const auto add = [&](int j) {
      if (mark[at(j)] == i) return;
      mark[at(j)] = i;
      neighbour.push_back(j);
    };
    for (int e = graph.start[at(b)]; e < graph.start[at(b) + 1]; ++e) {
      const int c = graph.neighbour[at(e)];
      if (!eliminated[at(c)]) {
        add(node[at(c)]);
      } else {
        for (int f = graph.start[at(c)]; f < graph.start[at(c) + 1]; ++f)
          add(node[at(graph.neighbour[at(f)])]);
      }
    }
    std::sort(neighbour.begin() + static_cast<std::ptrdiff_t>(first), neighbour.end());
    result.graph.start.push_back(static_cast<int>(neighbour.size()));
  }
  return result;
}

}  // namespace slom
