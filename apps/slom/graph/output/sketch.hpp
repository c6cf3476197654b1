// Contents of a drawing of a pose graph.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "graph/pose_graph.hpp"

namespace slom::app::graph {

struct Sketch {
  using Place = std::array<double, 3>;
  using Line = std::pair<int, int>;  ///< from one index in `poses` to another

  /// The map at an earlier time.
  struct Frame {
    std::uint64_t pose = 0;    ///< id of the last pose
    std::vector<Place> poses;  ///< the first poses of the sketch
    std::vector<Place> landmarks;
  };

  std::string name;            ///< name of the graph's file, without its folder
  bool is_flat = true;         ///< in the plane: the third coordinate is 0
  std::vector<Place> poses;    ///< sorted by id, or in feeding order
  std::vector<Line> path;      ///< edges between consecutive poses
  std::vector<Line> closures;  ///< all other edges
  std::vector<Place> landmarks;
  std::vector<int> fixed;     ///< indices of fixed poses in `poses`
  std::vector<Frame> frames;  ///< over time; empty: the map was not fed pose by pose

  /// Returns the smallest and largest coordinates. Their first coordinates always differ.
  std::pair<Place, Place> bounds() const;
};

template <int N>
Sketch::Place placeOf(const mtk::vect<N>& position) {
  Sketch::Place place{};
  for (int i = 0; i < N; ++i) place[std::size_t(i)] = position[i];
  return place;
}

/// Makes the sketch. `order`: the indices of the poses in sequence; empty: by ascending id.
template <class Pose>
Sketch sketchOf(const PoseGraph<Pose>& graph, std::vector<int> order = {});

}  // namespace slom::app::graph
