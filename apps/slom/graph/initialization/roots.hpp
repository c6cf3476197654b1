// Roots of start values in parts of a map that landmarks or priors hold.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// The roots: the first pose of each group of poses that edges connect, if no pose of the group is fixed and the group
/// sees fixed landmarks or has priors. During this object's lifetime, the roots are fixed in the graph, so that methods
/// that find a start can begin there. Each root is moved such that, along the edges, the first prior of a whole pose
/// holds. Without such a prior, landmarks and positions fit their places best.
template <class Pose>
class Roots {
 public:
  explicit Roots(PoseGraph<Pose>& graph);
  ~Roots();
  Roots(const Roots&) = delete;
  Roots& operator=(const Roots&) = delete;

  /// Restores the values that the roots in `graph` had.
  void restore(PoseGraph<Pose>& graph) const;

 private:
  PoseGraph<Pose>& graph_;
  std::vector<std::pair<std::size_t, Pose>> before_;  // index and value
};

}  // namespace slom::app::graph
