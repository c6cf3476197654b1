// Whether a scene can be fitted.
#pragma once

#include <string>
#include <vector>

#include "bundle/scene.hpp"

namespace slom::app::bundle {

/// Throws UserError for cameras and points without observations, and where a point has no image at the start.
/// Returns warnings: points that one camera alone sees.
std::vector<std::string> checkScene(const Scene& scene);

}  // namespace slom::app::bundle
