/// Pose graphs from and to files of g2o and TORO. docs/graph.md lists the tags.
#pragma once

#include <string>

#include "slom/io/pose_graph.hpp"

namespace slom::io {

/// Reads a pose graph, of the plane or of space, from a file of g2o or TORO; a pipe will do. Vertices that lines FIX name are
/// fixed; edges of a file without vertices get vertices with the value identity. Information matrices are taken as they are: the
/// estimator refuses those that are not positive definite.
/// Throws the errors of openInput; [slom.io.empty-file], [slom.io.no-edges]; and, naming file and line, [slom.io.bad-line] for a line
/// that is not as its tag asks, [slom.io.bad-graph] where the vertices are not those that edges name.
AnyPoseGraph readPoseGraph(const std::string& file);

/// The text of a file of g2o: all vertices, a line FIX for each fixed one, all edges; numbers with all digits, so that reading
/// it again gives the same graph. A graph that came from a file of TORO is written in g2o's format, too.
template <class Pose>
std::string toG2o(const PoseGraph<Pose>& graph);

/// The text of a file of TORO, likewise; rotations in space as roll, pitch and yaw, at any pitch. Lines FIX are those of g2o; TORO itself keeps
/// the first pose. Information matrices are written as they are. Throws [slom.io.no-toro] for a graph with landmarks or priors.
template <class Pose>
std::string toToro(const PoseGraph<Pose>& graph);

}  // namespace slom::io
