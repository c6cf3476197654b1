// Who sees whom: a scene as a graph of cameras and points.
#pragma once

#include <cstddef>
#include <vector>

#include "bundle/scene.hpp"

namespace slom::app::bundle {

/// The cameras and points of a part of a scene, each once.
struct Part {
  std::vector<int> cameras, points;
};

/// Pairs of a camera and a point that it sees, each once; pairs can be taken away.
class Sightings {
 public:
  explicit Sightings(const Scene& scene);

  /// Points that the camera sees, and cameras that see the point, as far as they are left.
  const std::vector<int>& pointsOf(int camera) const { return points_of_[std::size_t(camera)]; }
  const std::vector<int>& camerasOf(int point) const { return cameras_of_[std::size_t(point)]; }
  void remove(int camera, int point);
  /// The parts that share no point, of the pairs that are left, by their first cameras.
  std::vector<Part> parts() const;

 private:
  std::vector<std::vector<int>> points_of_, cameras_of_;
};

}  // namespace slom::app::bundle
