// What is fixed, so that the gauge of the map is.
#pragma once

#include <string>

#include "graph/fit/held.hpp"
#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// Fixes the first pose where the file has no lines FIX, and no priors. Each connected component of the graph needs a fixed pose, fixed
/// landmarks or priors of its own: throws UserError, naming the components without them, or, with `hold_parts`, fixes the first vertex of
/// each. What fixed landmarks and known positions leave free is the rotation about one of them, or about the line through several in space;
/// it is held at a pose.
template <class Pose>
Gauge fixGauge(PoseGraph<Pose>& graph, bool hold_parts);

}  // namespace slom::app::graph
