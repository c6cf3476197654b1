// Start values of all poses and landmarks.
#pragma once

#include "graph/pose_graph.hpp"

namespace slom::app::graph {

enum class Init {
  file,           ///< as the vertices of the file have them
  odometry,       ///< edges between i and i + 1, one after the other
  spanning_tree,  ///< the shortest ways, in edges, from the held poses
  chordal         ///< all edges at once, rotations first
};
const char* toString(Init init);

/// Gives all poses and landmarks that are not held their start values. Throws UserError where the method
/// cannot.
template <class Pose>
void findStart(PoseGraph<Pose>& graph, Init init);

}  // namespace slom::app::graph
