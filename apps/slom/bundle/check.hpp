// Whether a scene can be fitted.
#pragma once

#include <string>
#include <vector>

#include "bundle/scene.hpp"

namespace slom::app::bundle {

/// What a scene lacks.
struct SceneCheck {
  int parts = 1;  ///< parts that share no point
  std::vector<std::string>
      warnings;  ///< on points that one camera alone sees, cameras with too few points, parts
};

/// Throws UserError for cameras and points without observations, and where a point has no image at the start.
SceneCheck checkScene(const Scene& scene);

}  // namespace slom::app::bundle
