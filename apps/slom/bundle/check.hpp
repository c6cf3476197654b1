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

/// A warning on the points that lie behind cameras that see them; empty: none does.
std::string behindText(const Scene& scene);
/// `; the observation on line 17, of point 4 by camera 0, has 99 % of the RSS: correct or remove it`, where one has nearly all; else empty.
std::string dominantText(const Scene& scene);

/// Throws UserError for cameras and points without observations, and where a point has no image at the start.
SceneCheck checkScene(const Scene& scene);

}  // namespace slom::app::bundle
