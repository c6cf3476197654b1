/// The second attempt of a fit: where its long first steps have ended at a point from which it cannot go on, it begins again from the
/// start with short steps.
#pragma once

#include <optional>
#include <string>

#include "problem/value_snapshot.hpp"
#include "slom/optimize/algorithm.hpp"
#include "slom/optimize/evaluator.hpp"

namespace slom {

/// Keeps the values of the start and of the end of the first attempt, and decides which attempt the fit takes its result from. The
/// caller iterates in both.
class Restart {
 public:
  /// The current values are the start.
  explicit Restart(Evaluator& evaluator) : evaluator_(evaluator), start_(evaluator.problem()) {}

  /// Whether the first attempt, which `reason` has ended, has failed after it had moved the values.
  static bool isCalledFor(StopReason reason, const Summary& summary);
  /// Keeps the end of the first attempt and goes back to the start.
  void begin(StopReason reason, const Summary& summary);
  /// The algorithm of the second attempt: Levenberg-Marquardt with a large first damping.
  Algorithm& algorithm() { return cautious_; }
  /// Whether the second attempt has converged to a minimum with full rank that is not worse than where the first attempt ended. Linearises there.
  bool hasSucceeded(StopReason second, double rss);
  /// What the user should know after a success.
  std::string warning() const;
  /// After a second attempt that has not succeeded: keeps the better values of the two, whose RSS goes to `rss`. Returns the reason that
  /// the fit ends for.
  StopReason settle(StopReason second, double& rss);

 private:
  /// First damping where long steps have failed.
  static constexpr double kCautiousDamping = 1e3;

  Evaluator& evaluator_;
  ValueSnapshot start_;
  std::optional<ValueSnapshot> end_;  // values at the end of the first attempt
  StopReason first_ = StopReason::no_progress;
  double first_rss_ = 0;
  int failed_at_ = 0;  // iteration
  LevenbergMarquardt cautious_{kCautiousDamping};
};

}  // namespace slom
