// A pose graph as it stands in a file.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "graph/types.hpp"

namespace slom::app::graph {

/// What a node of the graph is, and where the file says so.
template <class Value>
struct Node {
  long id = 0;
  Value value;        ///< where it starts: from the file, or found by a start method
  int line = 0;       ///< of the vertex; of the first edge that names it where the file has no vertices
  bool held = false;  ///< keeps its value in the fit
};

/// `to` as seen from the pose `from`; both count nodes, not ids.
template <class Datum>
struct Edge {
  int from = 0;
  int to = 0;
  int line = 0;
  Datum measured;
  Symmetric<Datum::DOF> information;  ///< of the translation, then of the rotation; as the file has it
};

/// Of lines that were skipped.
struct UnknownTags {
  static constexpr std::size_t most = 5;

  std::map<std::string, int> lines;  ///< how many begin with each of the first ones
  int others = 0;                    ///< lines that begin with further ones

  void add(std::string_view tag);
};

template <class PoseType>
struct PoseGraph {
  using Pose = PoseType;

  std::string file;
  bool has_vertices = false;  ///< otherwise no value of a node means anything
  bool has_fix_lines = false;
  std::vector<Node<Pose>> poses;  ///< in the order of the file; by id where it has no vertices
  std::vector<Node<Point<Pose>>> landmarks;
  std::vector<Edge<Pose>> edges;             ///< from a pose to a pose
  std::vector<Edge<Point<Pose>>> sightings;  ///< of a landmark by a pose
  UnknownTags unknown_tags;
};

using AnyPoseGraph = std::variant<PoseGraph<Pose2>, PoseGraph<Pose3>>;

}  // namespace slom::app::graph
