/// Options of a fit, what happens in each iteration, and what came out.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace slom {

enum class StopReason {
  gradient,        ///< converged: the residual is orthogonal to all columns of J
  decrease,        ///< converged: neither the model nor the last step promises a smaller RSS
  step,            ///< converged: the last step moved nothing
  nothing_to_do,   ///< no unknowns, or no measurements
  max_iterations,  ///< not converged
  no_progress,     ///< not converged: no step, however short, makes the RSS smaller
  rank_deficient,  ///< not converged: the measurements do not determine all unknowns
  not_finite       ///< not converged: the step led to values where a residual is not finite
};

/// A few words: "relative decrease below tolerance".
const char* toString(StopReason reason);
bool isConverged(StopReason reason);

/// One line of progress.
struct IterationRecord {
  int iteration = 0;              ///< 0 is the start
  std::string algorithm;          ///< that made the step
  double rss = 0;                 ///< sum of squared whitened residuals after the step
  double relative_decrease = 0;   ///< (old - new) / old; negative when the RSS grew
  double gradient = 0;            ///< max_i |g_i| / (|J_i| |r|), where the step started
  double step = 0;                ///< max_i |d_i| |J_i|: the longest way, in standard deviations of that unknown alone
  double damping = 0;             ///< Levenberg-Marquardt's mu, dog leg's radius
  int trials = 1;                 ///< steps tried in this iteration
  double seconds = 0;             ///< since the start of optimize()
};

using Observer = std::function<void(const IterationRecord&)>;

/// A fit stops when one of the three tests holds.
struct Options {
  int max_iterations = 100;
  /// Cosine of the angle between the residual and each column of J: max_i |g_i| / (|J_i| |r|). More, Garbow and
  /// Hillstrom, "User guide for MINPACK-1", 1980, `gtol`.
  double gradient_tolerance = 1e-10;
  /// Actual and predicted decrease of the RSS, relative to the RSS; ibid., `ftol`.
  double decrease_tolerance = 1e-12;
  /// |d_i| relative to |x_i| (1 for angles) plus the standard deviation of that unknown alone; cf. ibid., `xtol`.
  double step_tolerance = 1e-10;
  /// When a Gauss-Newton step makes the RSS grow, take it back and go on with Levenberg-Marquardt.
  bool fall_back = true;
  /// Called after each iteration, and once before the first.
  Observer observer;
};

struct GroupSummary {
  std::string name;           ///< the label, or the measurement type
  int measurements = 0;
  int residuals = 0;          ///< sum of the lengths of their residuals
  double initial_rss = 0;
  double final_rss = 0;
  std::string derivatives;    ///< "exact" (dual numbers), "given" (the functor's own) or "numeric" (differences)
};

struct Summary {
  bool converged = false;
  StopReason stop_reason = StopReason::nothing_to_do;
  std::string message;                ///< the stop reason in a sentence, with names where something is wrong
  std::vector<std::string> warnings;  ///< variables without measurements, changes of the algorithm
  std::string algorithm;              ///< the one at the end
  std::string solver;                 ///< what solved the linear systems
  int iterations = 0;
  int variables = 0;                  ///< optimised ones
  int measurements = 0;               ///< number of scalar residuals
  int unknowns = 0;
  int redundancy = 0;                 ///< measurements - unknowns
  double initial_rss = 0;
  double final_rss = 0;
  double seconds = 0;
  std::vector<GroupSummary> groups;
  std::vector<IterationRecord> trace;

  /// final_rss / redundancy: near 1 when the stated uncertainties are right. NaN without redundancy.
  double chi2PerDof() const;
};

}  // namespace slom
