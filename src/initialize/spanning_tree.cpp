#include "slom/initialize/spanning_tree.hpp"

#include <cstdlib>
#include <functional>
#include <queue>
#include <string>

#include "base/index.hpp"

namespace slom::initialize {

Unreached::Unreached(int pose)
    : mtk::Error("slom.unreached-pose",
                 "no edges lead from a fixed pose to pose " + std::to_string(pose) +
                     "; add an edge between poses, or fix a pose of each part of the graph",
                 "pose " + std::to_string(pose)),
      pose_(pose) {}

namespace {

/// The edges at each pose. The edges of pose p are edges[first[p]] .. edges[first[p + 1] - 1].
struct EdgesAtPoses {
  std::vector<int> first, edges;
};

template <class Accept>
EdgesAtPoses edgesAtPoses(std::size_t poses, const std::vector<Ends>& ends, Accept accept) {
  EdgesAtPoses result;
  result.first.assign(poses + 1, 0);
  for (const Ends& edge : ends) {
    if (!accept(edge)) continue;
    ++result.first[at(edge.from) + 1];
    ++result.first[at(edge.to) + 1];
  }
  for (std::size_t p = 0; p < poses; ++p) result.first[p + 1] += result.first[p];
  result.edges.resize(at(result.first.back()));
  std::vector<int> next(result.first.begin(), result.first.end() - 1);
  for (std::size_t e = 0; e < ends.size(); ++e) {
    if (!accept(ends[e])) continue;
    result.edges[at(next[at(ends[e].from)]++)] = static_cast<int>(e);
    result.edges[at(next[at(ends[e].to)]++)] = static_cast<int>(e);
  }
  return result;
}

void requireReached(const std::vector<char>& is_reached) {
  for (std::size_t p = 0; p < is_reached.size(); ++p) {
    if (is_reached[p] == 0) throw Unreached(static_cast<int>(p));
  }
}

/// Returns the fixed poses; without any, the first pose.
std::vector<int> roots(const std::vector<char>& is_fixed) {
  std::vector<int> result;
  for (std::size_t p = 0; p < is_fixed.size(); ++p) {
    if (is_fixed[p] != 0) result.push_back(static_cast<int>(p));
  }
  if (result.empty() && !is_fixed.empty()) result.push_back(0);
  return result;
}

template <class Accept>
std::vector<TreeStep> breadthFirst(const std::vector<char>& is_fixed, const std::vector<Ends>& ends,
                                   Accept accept) {
  const std::size_t poses = is_fixed.size();
  const EdgesAtPoses edges_at = edgesAtPoses(poses, ends, accept);
  std::vector<int> queue = roots(is_fixed);
  std::vector<char> is_reached(poses, 0);
  for (const int pose : queue) is_reached[at(pose)] = 1;
  std::vector<TreeStep> tree;
  for (std::size_t done = 0; done < queue.size(); ++done) {
    const int here = queue[done];
    for (int k = edges_at.first[at(here)]; k < edges_at.first[at(here) + 1]; ++k) {
      const int e = edges_at.edges[at(k)];
      const bool is_forward = ends[at(e)].from == here;
      const int there = is_forward ? ends[at(e)].to : ends[at(e)].from;
      if (is_reached[at(there)] != 0) continue;
      tree.push_back({e, here, there, is_forward});
      is_reached[at(there)] = 1;
      queue.push_back(there);
    }
  }
  requireReached(is_reached);
  return tree;
}

}  // namespace

std::vector<TreeStep> spanningTree(const std::vector<char>& is_fixed, const std::vector<Ends>& edges) {
  return breadthFirst(is_fixed, edges, [](const Ends&) { return true; });
}

std::vector<TreeStep> odometryChain(const std::vector<char>& is_fixed, const std::vector<Ends>& edges) {
  return breadthFirst(is_fixed, edges, [](const Ends& edge) { return std::abs(edge.from - edge.to) == 1; });
}

std::vector<TreeStep> growth(const std::vector<char>& is_fixed, const std::vector<Ends>& edges) {
  const EdgesAtPoses edges_at = edgesAtPoses(is_fixed.size(), edges, [](const Ends&) { return true; });
  std::vector<char> is_reached(is_fixed.size(), 0);
  std::priority_queue<int, std::vector<int>, std::greater<>> next;
  const auto forEachEdge = [&](int pose, auto f) {
    for (int k = edges_at.first[at(pose)]; k < edges_at.first[at(pose) + 1]; ++k) {
      const int e = edges_at.edges[at(k)];
      const bool is_forward = edges[at(e)].to == pose;
      f(e, is_forward ? edges[at(e)].from : edges[at(e)].to, is_forward);
    }
  };
  const auto reach = [&](int pose) {
    is_reached[at(pose)] = 1;
    forEachEdge(pose, [&](int, int other, bool) {
      if (is_reached[at(other)] == 0) next.push(other);
    });
  };
  for (const int pose : roots(is_fixed)) reach(pose);
  std::vector<TreeStep> tree;
  while (!next.empty()) {
    const int pose = next.top();
    next.pop();
    if (is_reached[at(pose)] != 0) continue;
    TreeStep best{-1, -1, pose, true};
    forEachEdge(pose, [&](int e, int other, bool is_forward) {
      if (is_reached[at(other)] == 0) return;
      if (best.edge < 0 || std::abs(other - pose) < std::abs(best.parent - pose))
        best = {e, other, pose, is_forward};
    });
    tree.push_back(best);
    reach(pose);
  }
  requireReached(is_reached);
  return tree;
}

void detail::requireNodes(const std::vector<Ends>& ends, std::size_t sources, std::size_t targets,
                          const char* kind) {
  const auto is_bad = [](int i, std::size_t count) { return i < 0 || at(i) >= count; };
  for (std::size_t e = 0; e < ends.size(); ++e) {
    const bool is_source = is_bad(ends[e].from, sources);
    if (!is_source && !is_bad(ends[e].to, targets)) continue;
    const std::size_t count = is_source ? sources : targets;
    throw mtk::Error("slom.no-such-node",
                     std::string(kind) + " " + std::to_string(e) +
                         (is_source ? " leads from " : " leads to ") +
                         std::to_string(is_source ? ends[e].from : ends[e].to) + ", but there " +
                         (count == 1 ? "is 1 node" : "are " + std::to_string(count) + " nodes") +
                         ", numbered from 0; add the nodes before the edges",
                     std::string(kind) + " " + std::to_string(e));
  }
}

}  // namespace slom::initialize
