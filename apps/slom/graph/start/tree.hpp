// Poses by composing one edge after the other.
#pragma once

#include "graph/pose_graph.hpp"
#include "graph/start/start.hpp"

namespace slom::app::graph {

/// Breadth first from all held poses, so that each pose is reached by as few edges as can be; for
/// Init::odometry by edges between ids that follow each other alone. Throws UserError, naming `init`, when a
/// pose cannot be reached.
template <class Pose>
void composeAlongTree(PoseGraph<Pose>& graph, Init init);

}  // namespace slom::app::graph
