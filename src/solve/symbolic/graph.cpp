#include "graph.hpp"

#include <algorithm>

#include "base/index.hpp"

namespace slom {

namespace {

/// Calls f(a, b) for any two different blocks of a measurement, in both orders.
template <class F>
void forEachPair(const BlockStructure& structure, const F& f) {
  for (const MeasurementGroup& group : structure.groups) {
    for (int m = 0; m < group.size(); ++m) {
      const int* blocks = group.blocks.data() + at(m) * at(group.arity);
      for (int k = 0; k < group.arity; ++k) {
        for (int l = 0; l < k; ++l) {
          if (blocks[k] < 0 || blocks[l] < 0 || blocks[k] == blocks[l]) continue;
          f(blocks[k], blocks[l]);
          f(blocks[l], blocks[k]);
        }
      }
    }
  }
}

}  // namespace

BlockGraph makeGraph(const BlockStructure& structure) {
  const int n = structure.blockCount();
  BlockGraph graph;
  graph.dof.resize(at(n));
  for (int b = 0; b < n; ++b) graph.dof[at(b)] = structure.dof(b);
  std::vector<int> next(at(n) + 1, 0);
  forEachPair(structure, [&](int a, int) { ++next[at(a) + 1]; });
  for (int b = 0; b < n; ++b) next[at(b) + 1] += next[at(b)];
  std::vector<int> all(at(next.back()));
  const std::vector<int> begin = next;
  forEachPair(structure, [&](int a, int b) { all[at(next[at(a)]++)] = b; });

  graph.start.reserve(at(n) + 1);
  graph.start.push_back(0);
  graph.neighbour.reserve(all.size());
  for (int b = 0; b < n; ++b) {
    const auto first = all.begin() + begin[at(b)], last = all.begin() + begin[at(b) + 1];
    std::sort(first, last);
    graph.neighbour.insert(graph.neighbour.end(), first, std::unique(first, last));
    graph.start.push_back(static_cast<int>(graph.neighbour.size()));
  }
  return graph;
}

}  // namespace slom
