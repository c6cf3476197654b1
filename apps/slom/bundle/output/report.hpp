// What `slom bundle` says about the scene before and after the fit.
#pragma once

#include <string>
#include <vector>

#include "bundle/scene.hpp"

namespace slom::app::bundle {

/// Place, rotation and scale of a scene as a whole, which no image knows.
inline constexpr int gauge_directions = 7;

/// What was read, what is not determined, warnings.
std::string sceneText(const Scene& scene, const std::vector<std::string>& warnings);

/// `  RMS 3.2 px at the start, 0.8 px now`
std::string rmsText(double before, double after);

}  // namespace slom::app::bundle
