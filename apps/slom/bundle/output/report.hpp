// Texts of `slom bundle` about the scene before and after the fit.
#pragma once

#include <string>

#include "bundle/check.hpp"
#include "bundle/fit/free_directions.hpp"
#include "bundle/scene_numbers.hpp"

namespace slom::app::bundle {

/// Returns the lines on the input, on what no image determines, and the warnings.
std::string sceneText(const std::string& file, const SceneNumbers& numbers, const SceneCheck& check);

/// Returns a warning about free directions beyond place, rotation and scale, points seen once, and cameras with few
/// points; empty if there are none.
std::string furtherText(const FreeDirections& free);

/// Returns `  RMS 3.2 px at the start, 0.8 px now`.
std::string rmsText(double before, double after);

}  // namespace slom::app::bundle
