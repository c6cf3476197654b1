// What `slom bundle` says about the scene before and after the fit.
#pragma once

#include <string>

#include "bundle/check.hpp"
#include "bundle/fit/free_directions.hpp"
#include "bundle/scene.hpp"

namespace slom::app::bundle {

/// Returns the lines on what was read, what no image determines, and the warnings.
std::string sceneText(const Scene& scene, const SceneCheck& check);

/// A warning on the free directions that place, rotation and scale, points seen once and cameras with few points do not explain;
/// empty: there are none.
std::string furtherText(const FreeDirections& free);

/// `  RMS 3.2 px at the start, 0.8 px now`
std::string rmsText(double before, double after);

}  // namespace slom::app::bundle
