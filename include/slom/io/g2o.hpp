/// Pose graphs from and to files of g2o and TORO. docs/graph.md lists the tags.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "slom/io/container.hpp"
#include "slom/io/numbered_lines.hpp"
#include "slom/io/pose_graph.hpp"

namespace slom::io {

/// Reads a pose graph, in the plane or in space, from a file of g2o or TORO, a pipe, or a container. Vertices named by FIX lines are
/// fixed. If a file has no vertices, the vertices of its edges have the identity as value. Information matrices are not
/// checked here; the estimator refuses those that are not positive definite. Throws the errors of openInput,
/// [slom.io.empty-file] and [slom.io.no-edges]. With file and line, throws [slom.io.bad-line] for a line that does not
/// fit its tag, and [slom.io.bad-graph] if the vertices are not those that edges name.
AnyPoseGraph readPoseGraph(const std::string& file);

/// Reads a pose graph from some lines of a file of g2o or TORO. Throws as readPoseGraph() does, except that the lines
/// need not have an edge.
AnyPoseGraph parsePoseGraph(const std::string& file, const NumberedLines& lines);

/// Returns the lines of part `part` of `parts` of a container, by section, with their numbers in the text file. Throws
/// [slom.io.other-container] if it is no graph.
NumberedLines readLinesOfPart(const Container& container, int part, int parts);

/// What a line of such a file is about.
struct GraphLine {
  enum class Kind { vertex, edge, fix, sensor, prior, unknown };
  Kind kind = Kind::unknown;  ///< unknown: the tag, or the ids that should follow it
  std::uint64_t id = 0;       ///< of a vertex, prior or sensor; of the vertex that an edge comes from
  std::uint64_t to = 0;       ///< of the vertex that an edge leads to
};
/// Returns the kind of a line and its ids, without reading the rest. A FIX line may have more ids after the first.
GraphLine kindOfLine(std::string_view line);

/// Returns the text of a g2o file: all vertices, a FIX line for each fixed one, all edges. Numbers have all digits, so
/// reading the text again gives the same graph. A graph from a TORO file is written in g2o's format, too.
template <class Pose>
std::string toG2o(const PoseGraph<Pose>& graph);

/// Returns the text of a TORO file. Rotations in space are written as roll, pitch and yaw, at any pitch. FIX lines are
/// as in g2o; TORO itself keeps the first pose. Information matrices are written unchanged. Throws [slom.io.no-toro]
/// for a graph with landmarks or priors.
template <class Pose>
std::string toToro(const PoseGraph<Pose>& graph);

}  // namespace slom::io
