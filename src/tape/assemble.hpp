/// Translation of a recorded formula into the code of a tape: sums of products become single instructions, registers
/// are reused when their numbers are no longer needed.
#pragma once

#include <vector>

#include "slom/tape/tape.hpp"
#include "tape/graph.hpp"

namespace slom::tape {

/// A formula: nodes of a graph.
struct Formula {
  std::vector<VariableType> variables;
  int data = 0;
  std::vector<Id> residual;
  std::vector<Id> jacobian;  ///< rows x columns, column by column
  std::vector<Place> places;
};

/// Returns the code. Throws [slom.traced-too-long].
Code assemble(const Graph& graph, const Formula& formula);

}  // namespace slom::tape
