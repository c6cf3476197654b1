/// Names of the ways to find start values.
#pragma once

#include <utility>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom::initialize {

enum class Start {
  given,          ///< the values that are there
  odometry,       ///< edges between poses i and i + 1, one after the other
  spanning_tree,  ///< the fewest edges from the fixed poses
  chordal,        ///< all edges at once, rotations first
  build_up        ///< pose by pose, with short fits on the way
};
/// "spanning tree"
const char* toString(Start start);

/// The RSS that each start has; infinite where it cannot be found.
struct Choice {
  Start start = Start::given;
  std::vector<std::pair<Start, double>> costs;
};

}  // namespace slom::initialize
