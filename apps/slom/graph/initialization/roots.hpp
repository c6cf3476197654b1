// Where start values begin in parts of a map that landmarks or priors tie down.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// The first pose of each group of poses that edges connect, in which no pose is fixed, and which sees fixed landmarks or has priors. As long as
/// this exists, these poses are fixed in the graph, so that the ways to find a start can begin there. Each is moved to where, along the edges,
/// the first prior of a whole pose holds, or else landmarks and positions are best at their places.
template <class Pose>
class Roots {
 public:
  explicit Roots(PoseGraph<Pose>& graph);
  ~Roots();
  Roots(const Roots&) = delete;
  Roots& operator=(const Roots&) = delete;

  /// Gives the roots in `graph` the values that they had.
  void restore(PoseGraph<Pose>& graph) const;

 private:
  PoseGraph<Pose>& graph_;
  std::vector<std::pair<std::size_t, Pose>> before_;  // index and value
};

}  // namespace slom::app::graph
