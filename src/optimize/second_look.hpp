/// What is asked where a solver finds no rank: whether a solver that keeps more digits finds it.
#pragma once

#include <functional>
#include <memory>

#include "slom/linearize/structure.hpp"
#include "slom/solve/linear_solver.hpp"

namespace slom {

/// Whether J, which the solver keeps, shows to its last digits that a motion of the whole world changes no residual. Then no solver
/// finds full rank.
bool hasFreeGauge(const Problem& problem, const ProblemStructure& structure, const LinearSolver& solver);

struct SecondLook {
  SolveStatus status;                    ///< the last word; its `least` is filled
  std::unique_ptr<LinearSolver> solver;  ///< that found full rank; null: none did
  bool was_asked = false;                ///< a careful solver looked
};

/// `failed` is what `first` said. `fill` linearises into a solver that has been analysed. `digits`: what of a column of J, relative
/// to its length, is more than rounding.
SecondLook lookAgain(const Problem& problem, const ProblemStructure& structure, const LinearSolver& first,
                     SolveStatus failed, double digits, const std::function<void(LinearSolver&)>& fill);

}  // namespace slom
