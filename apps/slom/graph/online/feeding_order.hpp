// In which order the poses of a graph are fed.
#pragma once

#include <vector>

#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// Indices of the poses by rising id. One that no edge, no landmark seen before or fixed and no line FIX connects with those before it waits
/// until something does; what nothing ever connects comes last.
template <class Pose>
std::vector<int> feedingOrder(const PoseGraph<Pose>& graph);

}  // namespace slom::app::graph
