/// The second attempt of a fit. If long first steps end at a point from which the fit cannot continue, the fit begins
/// again from the start with short steps.
#pragma once

#include <optional>
#include <string>

#include "problem/value_snapshot.hpp"
#include "slom/optimize/algorithm.hpp"
#include "slom/optimize/evaluator.hpp"

namespace slom {

/// Keeps the values at the start and at the end of the first attempt, and decides which attempt gives the result. The
/// caller iterates in both.
class Restart {
 public:
  /// Takes the current values as the start.
  explicit Restart(Evaluator& evaluator) : evaluator_(evaluator), start_(evaluator.problem()) {}

  /// Returns whether the first attempt, which ended for `reason`, failed after it had moved the values.
  static bool isCalledFor(StopReason reason, const Summary& summary);
  /// Keeps the end of the first attempt and returns to the start.
  void begin(StopReason reason, const Summary& summary);
  /// Returns the algorithm of the second attempt: Levenberg-Marquardt with a large first damping.
  Algorithm& algorithm() { return cautious_; }
  /// Returns whether the second attempt converged to a minimum with full rank that is not worse than the end of the
  /// first attempt. Linearises there.
  bool hasSucceeded(StopReason second, double rss);
  /// Returns what to tell the user after a success.
  std::string warning() const;
  /// Ends a second attempt that did not succeed: keeps the better values of the two attempts and writes their RSS to
  /// `rss`. Returns the stop reason of the fit.
  StopReason settle(StopReason second, double& rss);

 private:
  /// First damping after long steps have failed.
  static constexpr double kCautiousDamping = 1e3;

  Evaluator& evaluator_;
  ValueSnapshot start_;
  std::optional<ValueSnapshot> end_;  // values at the end of the first attempt
  StopReason first_ = StopReason::no_progress;
  double first_rss_ = 0;
  int failed_at_ = 0;  // iteration at which the first attempt failed
  LevenbergMarquardt cautious_{kCautiousDamping};
};

}  // namespace slom
