/// The optimisation loop.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "slom/optimize/algorithm.hpp"

namespace slom {

/// The directions at the current values in which the unknowns can move without changing any residual, to first order.
struct FreeDirections {
  int count = 0;          ///< dimension of the null space of J
  int gauge = 0;          ///< of these, motions of the whole world and its scale
  Eigen::MatrixXd basis;  ///< unknowns x count, mostly zeros
};

/// The rank of J at the end of a fit.
struct RankAtEnd {
  SolveStatus singular_at;  ///< status of the solver when J lost full rank
  /// Unknowns that the measurements determined at the start but do not determine at the end of the fit; empty: none.
  std::vector<int> lost;
};

/// Takes steps until a test of `options` holds. Fills `rank` and in the summary the trace, stop reason, iterations, RSS
/// and warnings about changes of the algorithm. `find_free` examines the current values. It is called only if a fit
/// ends and the solver has not found full rank. With `sigma_is_estimated`, standard deviations are estimated from the
/// residuals. Throws [slom.bad-option]. If a user's function throws, the values are the best ones reached.
Summary runAlgorithm(Evaluator& evaluator, Algorithm& algorithm, const Options& options,
                     bool sigma_is_estimated, RankAtEnd& rank,
                     const std::function<FreeDirections()>& find_free);

}  // namespace slom
