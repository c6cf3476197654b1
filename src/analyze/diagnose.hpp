/// Looks a problem over at its current values: what it determines, what it does not, and why.
#pragma once

#include "analyze/linearized_problem.hpp"
#include "slom/analyze/diagnosis.hpp"

namespace slom {

/// Values count as a minimum from this Evaluator::orthogonality() down, for statements that hold at one alone.
inline constexpr double kAtMinimum = 1e-4;

/// Sparse: a factorisation and a few solutions with it.
Diagnosis diagnose(const LinearizedProblem& linearized);

}  // namespace slom
