/// Second look: if a solver finds no full rank, a solver that keeps more digits tries again.
#pragma once

#include <functional>
#include <memory>

#include "slom/linearize/structure.hpp"
#include "slom/solve/linear_solver.hpp"

namespace slom {

/// Returns whether a motion of the whole world changes no residual, to the last digits of J as kept by the solver. Then
/// no solver finds full rank.
bool hasFreeGauge(const Problem& problem, const ProblemStructure& structure, const LinearSolver& solver);

struct SecondLook {
  SolveStatus status;                    ///< the final status, including `least`
  std::unique_ptr<LinearSolver> solver;  ///< the solver that found full rank; null: none did
  bool was_asked = false;                ///< true: a careful solver tried
};

/// Looks again after `first` returned `failed`. `fill` linearises into a solver that has been analysed. `digits`:
/// fraction of the length of a column of J above which a number is more than rounding.
SecondLook lookAgain(const Problem& problem, const ProblemStructure& structure, const LinearSolver& first,
                     SolveStatus failed, double digits, const std::function<void(LinearSolver&)>& fill);

}  // namespace slom
