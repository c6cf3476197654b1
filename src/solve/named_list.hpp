// Declarations for the lines of named_list.inc. The source of each solver defines its own:
//
//     const NamedSolver detail::solvers::dense_cholesky{"dense-cholesky", "a dense one of J^T J",
//                                                           &makeSolver<DenseCholesky>};
#pragma once

#include "slom/solve/named.hpp"

namespace slom {

namespace detail::solvers {
#define SLOM_SOLVER(name) extern const NamedSolver name;
#include "solve/named_list.inc"
#undef SLOM_SOLVER
}  // namespace detail::solvers

template <class S>
std::unique_ptr<LinearSolver> makeSolver() {
  return std::make_unique<S>();
}

}  // namespace slom
