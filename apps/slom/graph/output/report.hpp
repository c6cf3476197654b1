// Texts of `slom graph` about the graph before the fit.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "graph/initialization/gauge.hpp"
#include "graph/initialization/start.hpp"
#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// Preparation of the fit.
struct Preparation {
  int repaired = 0;  ///< number of information matrices
  Gauge gauge;
  std::optional<StartFound> start;  ///< none: the map is fed pose by pose
};

/// Returns a sentence for each part of the file that the fit ignores or takes for granted.
template <class Pose>
std::vector<std::string> warningsOf(const PoseGraph<Pose>& graph);

/// Returns a text about the input, what is fixed, where the fit starts, and warnings.
template <class Pose>
std::string graphText(const PoseGraph<Pose>& graph, const Preparation& preparation);

}  // namespace slom::app::graph
