/// Orders of elimination that keep the factor sparse. Each order is a list of blocks.
#pragma once

#include <vector>

#include "graph.hpp"
#include "supernodes.hpp"

namespace slom {

/// Returns the order by approximate minimum degree.
///   source   Amestoy, Davis and Duff, "An approximate minimum degree ordering algorithm", 1996
std::vector<int> orderByMinimumDegree(const BlockGraph& graph);

/// Returns the order by nested dissection; empty if the library was built without METIS.
///   source   Karypis and Kumar, "A fast and high quality multilevel scheme for partitioning irregular graphs", 1998
std::vector<int> orderByNestedDissection(const BlockGraph& graph);

/// Returns the fronts by minimum degree, or by nested dissection if that needs fewer operations. Nested dissection is
/// tried only if the operations that it may save are worth its time.
Fronts chooseFronts(const BlockGraph& graph);

}  // namespace slom
