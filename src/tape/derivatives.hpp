/// Derivatives of a recorded formula, as nodes of its graph.
///   vertices   nodes that depend on unknowns, the unknowns, and a sink for each output
///   edges      local derivatives, from the operations or as stated for a node
///   method     elimination of all vertices between unknowns and sinks: forward, reverse and by Markowitz' rule; the
///              order with the fewest operations is kept
///   source     Griewank and Walther, "Evaluating derivatives", 2008, chapters 9 and 10
#pragma once

#include <unordered_map>
#include <vector>

#include "tape/graph.hpp"

namespace slom::tape {

/// A stated derivative: of a node with respect to another.
struct StatedTerm {
  Id of, coefficient;
};
using StatedDerivatives = std::unordered_map<Id, std::vector<StatedTerm>>;

/// Returns d output / d unknown, column by column; constant 0 where there is no dependence. `unknowns` are tangents.
std::vector<Id> differentiate(Graph& graph, const StatedDerivatives& stated, const std::vector<Id>& outputs,
                              const std::vector<Id>& unknowns);

/// Returns the number of instructions for these nodes. Sums that a multiplication can take over cost nothing.
int costOf(const Graph& graph, const std::vector<Id>& outputs);

}  // namespace slom::tape
