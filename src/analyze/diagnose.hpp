/// Diagnosis of a problem at its current values: what it determines, what it does not determine, and why.
#pragma once

#include "analyze/linearized_problem.hpp"
#include "slom/analyze/diagnosis.hpp"

namespace slom {

/// Limit of Evaluator::orthogonality() at and below which values count as a minimum.
inline constexpr double kAtMinimum = 1e-4;

/// Diagnoses the problem. Costs a sparse factorisation and a few solutions with it.
Diagnosis diagnose(const LinearizedProblem& linearized);

}  // namespace slom
