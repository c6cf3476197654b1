// Checks whether a scene can be fitted.
#pragma once

#include <string>
#include <vector>

#include "bundle/scene.hpp"

namespace slom::app::bundle {

/// Deficiencies of a scene.
struct SceneCheck {
  int parts = 1;  ///< parts that share no point
  /// About points seen by one camera only, cameras with too few points, and parts.
  std::vector<std::string> warnings;
};

/// Returns a warning about points that are behind cameras that see them; empty if there are none.
std::string behindText(const Scene& scene);
/// Returns, if one observation has nearly all of the RSS, a text such as
/// `; the observation on line 17, of point 4 by camera 0, has 99 % of the RSS: correct or remove it`; otherwise empty.
std::string dominantText(const Scene& scene);

/// Throws UserError for cameras and points without observations, and if a point has no image at the start.
SceneCheck checkScene(const Scene& scene);

}  // namespace slom::app::bundle
