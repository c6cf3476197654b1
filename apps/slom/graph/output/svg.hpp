// A pose graph in the plane as a picture.
#pragma once

#include <string>

#include "graph/output/sketch.hpp"

namespace slom::app::graph {

/// SVG with the trajectory, the other edges thin in the background, landmarks as dots, fixed poses as rings, and a bar
/// for the scale. Follows the reader's choice of light or dark.
std::string toSvg(const Sketch& sketch);

}  // namespace slom::app::graph
