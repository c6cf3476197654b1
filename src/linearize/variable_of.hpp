/// The variable that an unknown belongs to.
#pragma once

#include <algorithm>

#include "slom/linearize/structure.hpp"

namespace slom {

inline int variableOf(const ProblemStructure& structure, int unknown) {
  const auto& offset = structure.system.offset;
  return static_cast<int>(std::upper_bound(offset.begin(), offset.end(), unknown) - offset.begin()) - 1;
}

}  // namespace slom
