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

/// Returns `file`, `odometry`, `spanning-tree`, `chordal` or `build-up`.
const char* optionOf(Start start);
/// Parses the name of a start; none: `auto`. Throws UserError.
std::optional<Start> parseStart(const std::string& text);

/// The starts that were tried, and the one that the graph begins from.
struct StartFound {
  Start start = Start::given;
  std::vector<Start> tried;    ///< with --init auto, those that could be found
  bool is_checkpoint = false;  ///< the values are those of a checkpoint
};

/// Gives all poses and landmarks that are not fixed their start values. Without `start`, tries the file (if it has
/// vertices), odometry, spanning tree and chordal relaxation, and with landmarks also the build-up. Keeps those with
/// the lowest RSS. Throws UserError if no start is found.
template <class Pose>
StartFound findStart(PoseGraph<Pose>& graph, std::optional<Start> start, const GraphModel& model);

}  // namespace slom::app::graph
