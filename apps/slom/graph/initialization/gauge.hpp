// The gauge of a map, and what is fixed to determine it.
#pragma once

#include <string>

#include "graph/fit/held.hpp"
#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// Fixes the first pose if the file has no FIX lines and no priors. Each connected component of the graph needs its own
/// fixed pose, fixed landmarks or priors. For components without them, throws UserError that names them or, with
/// `hold_parts`, fixes the first vertex of each. Fixed landmarks and known positions may leave a rotation free: about
/// one of them, or in space about the line through several. This rotation is held at a pose.
template <class Pose>
Gauge fixGauge(PoseGraph<Pose>& graph, bool hold_parts);

}  // namespace slom::app::graph
