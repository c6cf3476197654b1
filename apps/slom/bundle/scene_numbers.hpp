// Cameras and points by their numbers in the file.
#pragma once

#include <cstdint>
#include <vector>

#include "bundle/scene.hpp"

namespace slom::app::bundle {

/// The place of a scene in the whole one. `cameras` and `points`: by place in the scene, the numbers in the file.
struct SceneNumbers {
  std::vector<int> cameras, points;
  int camera_count = 0, point_count = 0;  ///< of the whole scene
  std::int64_t observation_count = 0;

  /// Returns the numbers of a scene that is whole.
  static SceneNumbers ofWhole(const Scene& scene);
};

}  // namespace slom::app::bundle
