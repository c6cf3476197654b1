/// The loop of a fit.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "slom/optimize/algorithm.hpp"

namespace slom {

/// The directions in which the unknowns can move at the current values without changing any residual, to first order.
struct FreeDirections {
  int count = 0;          ///< dimension of the null space of J
  int gauge = 0;          ///< of these: motions of the whole world, and its scale
  Eigen::MatrixXd basis;  ///< unknowns x count, with few entries that are not 0
};

/// Where the rank of a fit ended.
struct RankAtEnd {
  SolveStatus singular_at;  ///< of the solver, when the rank ran out
  /// Unknowns that the measurements determined at the start and do not determine where the fit has ended; empty: none.
  std::vector<int> lost;
};

/// Steps until a test of `options` holds. Fills the summary's trace, stop reason, iterations, RSS and warnings about
/// changes of the algorithm, and `rank`. `find_free` examines the current values; it is asked only where a fit ends without the solver
/// having found full rank. With `sigma_is_estimated` standard deviations are estimated from the residuals. Throws [slom.bad-option]. If
/// a user's function throws, the values are the best ones reached.
Summary runAlgorithm(Evaluator& evaluator, Algorithm& algorithm, const Options& options,
                     bool sigma_is_estimated, RankAtEnd& rank,
                     const std::function<FreeDirections()>& find_free);

}  // namespace slom
