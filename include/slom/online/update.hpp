/// Options and summary of Estimator::update().
#pragma once

#include <iosfwd>
#include <limits>
#include <string>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// When Estimator::update ends, and whether it tries refused measurements again.
struct UpdateOptions {
  /// Relative tolerance, between 0 and 1. Steps end when the predicted decrease of the RSS for another step is at most
  /// this fraction of the RSS, or at most the rounding errors of the residuals.
  double tolerance = 1e-6;
  /// Maximum number of steps, including those of trials. The next call continues.
  int max_steps = 100;
  /// Number of operations, as UpdateSummary::flops counts them, after which no further step begins; positive. The next
  /// call continues. So a call takes this number, plus one step and the factorisation of what has changed. With a
  /// budget, optimize() does not take over unless there are bounds; UpdateSummary::needs_optimize says when it would
  /// have. The budget counts operations rather than seconds because these are equal on all machines.
  double budget = std::numeric_limits<double>::infinity();
  /// If true, each new measurement that its loss refuses (weight below 0.1) is tried. A trial looks for values that
  /// agree with the measurement and keeps them if the RSS is lower there. So false loop closures that came first do not
  /// make later true ones look wrong. For losses whose weight falls to 0, such as GemanMcClure and Tukey. Costs a few
  /// steps for each refused measurement.
  ///
  /// If the budget or max_steps leaves no room, trials wait for later calls, the oldest first. A trial that a limit
  /// interrupts is undone and continues in a later call. Nothing is tried if there are bounds, and the measurements
  /// present in the first call are not tried.
  bool reconsider = false;
};

/// Outcome of a call of Estimator::update.
struct UpdateSummary {
  bool converged = false;  ///< `promise` is within the tolerance
  std::string message;     ///< reason for the end, in a sentence
  double rss = 0;          ///< at the end
  /// Decrease of the RSS that the linear model predicts for another step: g^T H^-1 g. NaN if there are bounds.
  double promise = 0;
  int steps = 0;
  int variables_moved = 0;          ///< counted in each step
  int measurements_linearized = 0;  ///< counted each time
  int fronts_factorized = 0;        ///< parts of the factor that were recomputed
  int fronts_solved = 0;            ///< parts of the factor that a gradient passed through, counted each time
  /// Additions and multiplications of factorisations, solutions and products with Jacobians, without measurement
  /// functions.
  double flops = 0;
  int reconsidered = 0;  ///< refused measurements whose trials were completed, each counted once
  /// Measurements counted in `reconsidered` that are no longer refused, because the map was moved for them.
  int accepted = 0;
  int waiting = 0;         ///< new measurements that later calls with `reconsider` will examine or try
  bool reordered = false;  ///< all variables were reordered
  /// The budget ended before the tolerance was met: `promise` is left for later calls.
  bool is_put_off = false;
  /// optimize() took over, in time proportional to the whole problem. Reasons: there are bounds, or steps led uphill,
  /// to values without residuals, or to values at which an unknown has no influence.
  bool used_optimize = false;
  int optimize_iterations = 0;  ///< iterations of optimize() if it took over; the other counts exclude them
  /// optimize() would have taken over, but there is a budget. Call optimize() when there is time.
  bool needs_optimize = false;
  /// Names of components that no measurement determines, given those of other variables. They keep their values until
  /// one does. Empty if there are bounds.
  std::vector<std::string> undetermined;
};

/// Prints a few lines for people.
std::ostream& operator<<(std::ostream& os, const UpdateSummary& summary);

}  // namespace slom
