/// What Estimator::update() does, and how it went.
#pragma once

#include <iosfwd>
#include <limits>
#include <string>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// When Estimator::update ends, and whether refused measurements are tried again.
struct UpdateOptions {
  /// Steps are taken until the predicted decrease of the RSS for another one is at most this share of it, or at most the rounding
  /// errors of the residuals. Between 0 and 1.
  double tolerance = 1e-6;
  /// Largest number of steps, those of trials included. The next call continues.
  int max_steps = 100;
  /// Operations, as UpdateSummary::flops counts them, after which no further step begins; the next call continues. A call thus takes as many,
  /// and what a step does and the factorisation of what has changed. optimize() does not take over then, unless there are
  /// bounds, and UpdateSummary::needs_optimize says where it would. Positive; counts instead of seconds, as they are the same on any machine.
  double budget = std::numeric_limits<double>::infinity();
  /// Whether each new measurement that its loss refuses (with a weight below 0.1) is tried: values that agree with it are looked for, and
  /// kept where the RSS is lower there. Thus false closures of loops that came first do not make the true ones that come later
  /// look wrong. For losses whose weight falls to nothing, as GemanMcClure and Tukey. Takes a few steps for each that is refused. What the
  /// budget or max_steps leaves no room for waits for later calls, the oldest first; a trial that one of them ends is taken back, and
  /// goes on there. Nothing is tried where there are bounds, nor of what was there in the first call.
  bool reconsider = false;
};

/// How a call of Estimator::update went.
struct UpdateSummary {
  bool converged = false;  ///< `promise` is within the tolerance
  std::string message;     ///< why it ended, in a sentence
  double rss = 0;          ///< at the end
  /// The decrease of the RSS that the linear model predicts for another step: g^T H^-1 g. NaN where there are bounds.
  double promise = 0;
  int steps = 0;
  int variables_moved = 0;          ///< counted in each step
  int measurements_linearized = 0;  ///< counted each time
  int fronts_factorized = 0;        ///< parts of the factor that were computed again
  int fronts_solved = 0;  ///< parts of the factor that a gradient went up through, counted each time
  /// Additions and multiplications of factorising and solving, and of products with Jacobians; not those of measurement functions.
  double flops = 0;
  int reconsidered = 0;    ///< refused measurements that were tried to the end, once each
  int accepted = 0;        ///< those of them that are no longer refused, as the map was moved for them
  int waiting = 0;         ///< new measurements that later calls with `reconsider` are to look at, or to try
  bool reordered = false;  ///< all variables were reordered
  /// The budget was used up before the tolerance was met: `promise` is left for later calls.
  bool is_put_off = false;
  /// optimize() took over, in time proportional to everything: there are bounds, or steps went uphill, to values without residuals or to where an
  /// unknown has lost its influence.
  bool used_optimize = false;
  int optimize_iterations = 0;  ///< of optimize(), where it took over; the other counts are without these
  /// It would have taken over, but there is a budget: call it when there is time.
  bool needs_optimize = false;
  /// Names of components that no measurement determines, given those of other variables; they keep their values until one does.
  /// Not filled where there are bounds.
  std::vector<std::string> undetermined;
};

/// A few lines for people.
std::ostream& operator<<(std::ostream& os, const UpdateSummary& summary);

}  // namespace slom
