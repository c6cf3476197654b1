/// Orders of elimination that keep the factor sparse. Each order is a list of blocks.
#pragma once

#include <vector>

#include "graph.hpp"
#include "supernodes.hpp"

namespace slom {

/// Approximate minimum degree.
///   source   Amestoy, Davis and Duff, "An approximate minimum degree ordering algorithm", 1996
std::vector<int> orderByMinimumDegree(const BlockGraph& graph);

/// Nested dissection; empty where the library was built without METIS.
///   source   Karypis and Kumar, "A fast and high quality multilevel scheme for partitioning irregular graphs", 1998
std::vector<int> orderByNestedDissection(const BlockGraph& graph);

/// The fronts by minimum degree, or by nested dissection where that needs fewer operations; it is tried only where the
/// operations that it may save are worth its time.
Fronts chooseFronts(const BlockGraph& graph);

}  // namespace slom
