// Order in which the poses of a graph are fed.
#pragma once

#include <vector>

#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// Returns indices of the poses by ascending id. A pose is connected if an edge, a landmark seen before, a fixed
/// landmark or a FIX line connects it with earlier poses. A pose that is not connected yet waits. Poses that are never
/// connected come last.
template <class Pose>
std::vector<int> feedingOrder(const PoseGraph<Pose>& graph);

}  // namespace slom::app::graph
