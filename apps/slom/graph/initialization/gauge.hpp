// Which poses are fixed, so that the gauge of the map is.
#pragma once

#include <string>

#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// Fixes the first pose where the file has no lines FIX. Each connected component of the graph needs a fixed pose of its own:
/// throws UserError, naming the components without one, or, with `hold_parts`, fixes the first vertex of each. Returns what it
/// has fixed, in words: "pose 0", "the first vertex of 3 more parts"; empty where the lines FIX suffice.
template <class Pose>
std::string fixGauge(PoseGraph<Pose>& graph, bool hold_parts);

}  // namespace slom::app::graph
