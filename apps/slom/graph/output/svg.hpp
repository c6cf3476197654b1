// A pose graph in the plane as a picture.
#pragma once

#include <string>

#include "graph/output/sketch.hpp"

namespace slom::app::graph {

/// Returns an SVG with the trajectory, a scale bar, and the other edges thin in the background. Landmarks are dots,
/// fixed poses rings. Colours follow the reader's choice of light or dark.
std::string toSvg(const Sketch& sketch);

}  // namespace slom::app::graph
