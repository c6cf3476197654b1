// Declarations for the lines of named_list.inc. The source of each algorithm defines its own:
//
//     const NamedAlgorithm detail::algorithms::line_search{"line-search", "Gauss-Newton with a line search",
//                                                                 &makeAlgorithm<LineSearch>};
#pragma once

#include "slom/optimize/named.hpp"

namespace slom {

namespace detail::algorithms {
#define SLOM_ALGORITHM(name) extern const NamedAlgorithm name;
#include "optimize/named_list.inc"
#undef SLOM_ALGORITHM
}  // namespace detail::algorithms

template <class A>
std::unique_ptr<Algorithm> makeAlgorithm() {
  return std::make_unique<A>();
}

}  // namespace slom
