#include "graph/start/tree.hpp"

#include <cstdlib>
#include <vector>

#include <fmt/format.h>

#include "error.hpp"

namespace slom::app::graph {

namespace {

/// The edges at each pose: those of pose p are edges[first[p]] .. edges[first[p + 1] - 1].
struct EdgesAtPoses {
  std::vector<int> first, edges;
};

template <class Pose, class Accept>
EdgesAtPoses edgesAtPoses(const PoseGraph<Pose>& graph, Accept accept) {
  EdgesAtPoses at;
  at.first.assign(graph.poses.size() + 1, 0);
  for (const auto& edge : graph.edges) {
    if (!accept(edge)) continue;
    ++at.first[std::size_t(edge.from) + 1];
    ++at.first[std::size_t(edge.to) + 1];
  }
  for (std::size_t p = 0; p < graph.poses.size(); ++p) at.first[p + 1] += at.first[p];
  at.edges.resize(std::size_t(at.first.back()));
  std::vector<int> next(at.first.begin(), at.first.end() - 1);
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const auto& edge = graph.edges[e];
    if (!accept(edge)) continue;
    at.edges[std::size_t(next[std::size_t(edge.from)]++)] = int(e);
    at.edges[std::size_t(next[std::size_t(edge.to)]++)] = int(e);
  }
  return at;
}

template <class Pose>
[[noreturn]] void refuse(const PoseGraph<Pose>& graph, Init init, long id) {
  throw UserError(init == Init::odometry ? fmt::format("--init odometry: no chain of edges i, i+1 leads from "
                                                       "a held pose to pose {} of {}; use --init "
                                                       "spanning-tree",
                                                       id, graph.file)
                                         : fmt::format("--init {}: no edge between poses leads to pose {} of "
                                                       "{}, which landmarks alone connect with the "
                                                       "rest; add an edge, or vertices for all",
                                                       toString(init), id, graph.file));
}

}  // namespace

template <class Pose>
void composeAlongTree(PoseGraph<Pose>& graph, Init init) {
  const EdgesAtPoses at = edgesAtPoses(graph, [&](const Edge<Pose>& edge) {
    const auto id = [&](int pose) { return graph.poses[std::size_t(pose)].id; };
    return init != Init::odometry || std::labs(id(edge.from) - id(edge.to)) == 1;
  });
  std::vector<int> queue;
  std::vector<char> is_reached(graph.poses.size(), 0);
  const auto reach = [&](std::size_t pose) {
    is_reached[pose] = 1;
    queue.push_back(int(pose));
  };
  for (std::size_t p = 0; p < graph.poses.size(); ++p) {
    if (graph.poses[p].held) reach(p);
  }
  for (std::size_t done = 0; done < queue.size(); ++done) {
    const auto here = std::size_t(queue[done]);
    for (int k = at.first[here]; k < at.first[here + 1]; ++k) {
      const Edge<Pose>& edge = graph.edges[std::size_t(at.edges[std::size_t(k)])];
      const bool forward = std::size_t(edge.from) == here;
      const auto there = std::size_t(forward ? edge.to : edge.from);
      if (is_reached[there] != 0) continue;
      graph.poses[there].value =
          graph.poses[here].value * (forward ? edge.measured : edge.measured.inverse());
      reach(there);
    }
  }
  for (std::size_t p = 0; p < graph.poses.size(); ++p) {
    if (is_reached[p] == 0) refuse(graph, init, graph.poses[p].id);
  }
}

template void composeAlongTree(PoseGraph<Pose2>&, Init);
template void composeAlongTree(PoseGraph<Pose3>&, Init);

}  // namespace slom::app::graph
