/// The loop of a fit.
#pragma once

#include "slom/optimize/algorithm.hpp"

namespace slom {

/// Steps until a test of `options` holds. Fills the summary's trace, stop reason, iterations, RSS and warnings about
/// changes of the algorithm; `singular_at` gets the status of the solver when the rank ran out.
/// With `sigma_is_estimated` standard deviations are estimated from the residuals. Throws [slom.bad-option].
Summary runAlgorithm(Evaluator& evaluator, Algorithm& algorithm, const Options& options,
                     bool sigma_is_estimated, SolveStatus& singular_at);

}  // namespace slom
