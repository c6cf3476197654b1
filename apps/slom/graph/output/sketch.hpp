// What a drawing of a pose graph shows.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "graph/pose_graph.hpp"

namespace slom::app::graph {

struct Sketch {
  using Place = std::array<double, 3>;
  using Line = std::pair<int, int>;  ///< from one place of `poses` to another

  std::string name;            ///< of the graph's file, without its folder
  bool is_flat = true;         ///< in the plane: the third coordinate is 0
  std::vector<Place> poses;    ///< by rising id
  std::vector<Line> path;      ///< edges between poses that follow each other
  std::vector<Line> closures;  ///< all other edges
  std::vector<Place> landmarks;
  std::vector<int> fixed;  ///< indices of fixed poses in `poses`

  /// Smallest and largest coordinates; the first of them always differ.
  std::pair<Place, Place> bounds() const;
};

template <class Pose>
Sketch sketchOf(const PoseGraph<Pose>& graph);

}  // namespace slom::app::graph
