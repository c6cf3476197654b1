// Checks whether a scene can be fitted, and what the fit has made of it. Several processes check the whole scene, each
// with a part: all call these functions and get the same.
#pragma once

#include <string>
#include <vector>

#include <slom/base/collective.hpp>

#include "bundle/scene.hpp"
#include "bundle/scene_numbers.hpp"

namespace slom::app::bundle {

/// Deficiencies of a scene.
struct SceneCheck {
  int parts = 1;                     ///< parts that share no point
  std::size_t points_seen_once = 0;  ///< points that only one camera sees
  /// About points seen by one camera only, cameras with too few points, and parts.
  std::vector<std::string> warnings;
};

/// Throws UserError for cameras and points without observations, and if a point has no image at the start.
SceneCheck checkScene(const Scene& scene, const SceneNumbers& numbers,
                      const Collective& processes = singleProcess());

/// Returns a warning about points that are behind cameras that see them; empty if there are none.
std::string behindText(const Scene& scene, const SceneNumbers& numbers,
                       const Collective& processes = singleProcess());
/// Returns, if one observation has nearly all of the RSS, a text such as
/// `; the observation on line 17, of point 4 by camera 0, has 99 % of the RSS: correct or remove it`; otherwise empty.
std::string dominantText(const Scene& scene, const SceneNumbers& numbers,
                         const Collective& processes = singleProcess());

}  // namespace slom::app::bundle
