// A scene as a graph of cameras and points.
#pragma once

#include <cstddef>
#include <vector>

#include "bundle/scene.hpp"

namespace slom::app::bundle {

/// The cameras and points of a part of a scene, each once.
struct Part {
  std::vector<int> cameras, points;
};

/// Pairs of a camera and a point that it sees, each once. Pairs can be removed.
class Sightings {
 public:
  explicit Sightings(const Scene& scene);

  /// Returns the remaining points that the camera sees; camerasOf(): the remaining cameras that see the point.
  const std::vector<int>& pointsOf(int camera) const { return points_of_[std::size_t(camera)]; }
  const std::vector<int>& camerasOf(int point) const { return cameras_of_[std::size_t(point)]; }
  void remove(int camera, int point);
  /// Returns the parts of the remaining pairs that share no point, ordered by their first cameras.
  std::vector<Part> parts() const;

 private:
  std::vector<std::vector<int>> points_of_, cameras_of_;
};

}  // namespace slom::app::bundle
