// Start values of all poses and landmarks.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <slom/initialize/start.hpp>

#include "graph/fit/model.hpp"
#include "graph/pose_graph.hpp"

namespace slom::app::graph {

using initialize::Start;

/// `file`, `odometry`, `spanning-tree`, `chordal` or `build-up`
const char* optionOf(Start start);
/// None: `auto`. Throws UserError.
std::optional<Start> parseStart(const std::string& text);

/// What was tried, and which of it the graph starts from.
struct StartFound {
  Start start = Start::given;
  std::vector<Start> tried;  ///< with --init auto those that could be found
};

/// Gives all poses and landmarks that are not fixed their start values. Without `start` from the file where it
/// has vertices, odometry, spanning tree and chordal relaxation, with landmarks also from the build-up, those
/// with the lowest RSS. Throws UserError where no start is found.
template <class Pose>
StartFound findStart(PoseGraph<Pose>& graph, std::optional<Start> start, const GraphModel& model);

}  // namespace slom::app::graph
