/// Checks of lengths. Solvers and algorithms may be a user's own; their results must have the lengths of the problem.
#pragma once

#include <Eigen/Core>

#include "slom/solve/linear_solver.hpp"

namespace slom {

/// Throws [slom.wrong-length], naming the solver, unless its gradient and the diagonal of its H have an entry for each
/// unknown.
void requireGradientLengths(const LinearSolver& solver, int unknowns);

/// Throws [slom.wrong-length] unless a solution of the solver has a row for each unknown.
void requireSolutionLength(const LinearSolver& solver, Eigen::Index rows, int unknowns);

/// Throws [slom.wrong-length] unless a step that an algorithm wants to take has an entry for each unknown.
void requireStepLength(Eigen::Index entries, int unknowns);

}  // namespace slom
