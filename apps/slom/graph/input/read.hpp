// A pose graph from a g2o or TORO file.
#pragma once

#include <string>

#include "graph/pose_graph.hpp"

namespace slom::app::graph {

/// Throws UserError, with file and line, for whatever is wrong with the lines of the file or with the
/// vertices that its edges name. Information matrices are taken as they are.
AnyPoseGraph readPoseGraph(const std::string& file);

}  // namespace slom::app::graph
