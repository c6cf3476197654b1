/// Ways to find start values, and their names.
#pragma once

#include <utility>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom::initialize {

enum class Start {
  given,          ///< the present values
  odometry,       ///< edges between poses i and i + 1, one after another
  spanning_tree,  ///< the fewest edges from the fixed poses
  chordal,        ///< all edges at once, rotations first
  build_up        ///< pose by pose, with short fits in between
};
/// Returns the name, such as "spanning tree".
const char* toString(Start start);

/// The chosen start, and the RSS of each; infinite for a start that cannot be found.
struct Choice {
  Start start = Start::given;
  std::vector<std::pair<Start, double>> costs;
};

}  // namespace slom::initialize
