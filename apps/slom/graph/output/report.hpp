// What `slom graph` says about the graph before it fits it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "graph/initialization/gauge.hpp"
#include "graph/initialization/start.hpp"
#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// How the fit was prepared.
struct Preparation {
  int repaired = 0;  ///< information matrices
  Gauge gauge;
  std::optional<StartFound> start;  ///< none: the map is fed pose by pose
};

/// What of the file the fit does without, or takes for granted: a sentence each.
template <class Pose>
std::vector<std::string> warningsOf(const PoseGraph<Pose>& graph);

/// What was read, what is fixed, where the fit starts, warnings.
template <class Pose>
std::string graphText(const PoseGraph<Pose>& graph, const Preparation& preparation);

}  // namespace slom::app::graph
