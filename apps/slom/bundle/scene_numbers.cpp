#include "bundle/scene_numbers.hpp"

#include <numeric>

namespace slom::app::bundle {

SceneNumbers SceneNumbers::ofWhole(const Scene& scene) {
  SceneNumbers numbers;
  numbers.cameras.resize(scene.cameras.size());
  std::iota(numbers.cameras.begin(), numbers.cameras.end(), 0);
  numbers.points.resize(scene.points.size());
  std::iota(numbers.points.begin(), numbers.points.end(), 0);
  numbers.camera_count = int(scene.cameras.size());
  numbers.point_count = int(scene.points.size());
  numbers.observation_count = std::int64_t(scene.observations.size());
  return numbers;
}

}  // namespace slom::app::bundle
