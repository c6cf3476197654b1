/// Division of the vertices of a graph, which have any ids, among the processes.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "slom/distributed/processes.hpp"

namespace slom::distributed {

/// Ranges of ids, such that each process gets about as many. The processes find what belongs to an id in the process of
/// its range.
class IdRanges {
 public:
  /// Each process passes its own `ids`.
  IdRanges(const Processes& processes, std::vector<std::uint64_t> ids);
  int processOf(std::uint64_t id) const;

 private:
  std::vector<std::uint64_t> first_;  // first id of each process but the first
};

/// Which process fits which vertex: a partition of the graph of vertices and edges.
class Division {
 public:
  using Edge = std::pair<std::uint64_t, std::uint64_t>;
  /// Each process passes some of the vertices and some of the edges, any of them. Edges that lead to no vertex do not
  /// count. All processes call it.
  Division(const Processes& processes, const std::vector<std::uint64_t>& vertices,
           const std::vector<Edge>& edges);

  /// Makes processOf() known for these ids. All processes call it.
  void learn(const std::vector<std::uint64_t>& ids);
  /// Returns the process of a vertex whose id has been learnt, or of the range of an id that no vertex has.
  int processOf(std::uint64_t id) const { return process_of_.at(id); }

 private:
  template <class F>
  std::vector<std::int64_t> ask(std::vector<std::uint64_t>& ids, const F& answer) const;

  const Processes& processes_;
  IdRanges ranges_;
  std::vector<std::uint64_t> vertices_;  // vertices in the range of this process, ascending
  std::vector<int> process_of_vertex_;   // by place in vertices_
  std::unordered_map<std::uint64_t, int> process_of_;
};

}  // namespace slom::distributed
