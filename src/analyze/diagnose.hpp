/// Looks a problem over at its current values: what it determines, what it does not, and why.
#pragma once

#include "slom/analyze/diagnosis.hpp"
#include "slom/optimize/system.hpp"

namespace slom {

/// Values count as a minimum from this System::orthogonality() down, for statements that hold at one alone.
inline constexpr double kAtMinimum = 1e-4;

/// Sparse: a factorisation and a few solutions with it.
Diagnosis diagnose(System& system, Linearizer& linearizer);

/// The error of an analysis that needs a full rank: [slom.free-gauge] with the motions that are free or, where that is not
/// the cause, singularError.
Error undeterminedError(System& system, Linearizer& linearizer, const SolveStatus& status);

}  // namespace slom
