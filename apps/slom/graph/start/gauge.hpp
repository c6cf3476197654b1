// Which poses are held, so that the map cannot float.
#pragma once

#include <string>

#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// Holds the first pose where the file has no lines FIX. A part of the graph that no edge connects with the
/// rest needs a held pose of its own: throws UserError, naming the parts without one, or holds the first
/// vertex of each with `hold_parts`. Returns what it held, in words: "pose 0", "the first vertex of 3 parts";
/// empty when the lines FIX do it all.
template <class Pose>
std::string holdGauge(PoseGraph<Pose>& graph, bool hold_parts);

}  // namespace slom::app::graph
