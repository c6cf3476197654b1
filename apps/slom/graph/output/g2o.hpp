// A pose graph as a file of g2o.
#pragma once

#include <string>

#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// All vertices, lines FIX for those that are held, all edges; numbers with all digits. A graph that came
/// from TORO's format is written in g2o's too.
template <class Pose>
std::string toG2o(const PoseGraph<Pose>& graph);

}  // namespace slom::app::graph
