#include "optimize/restart.hpp"

namespace slom {

bool Restart::isCalledFor(StopReason reason, const Summary& summary) {
  const bool has_moved = summary.trace.back().rss != summary.initial_rss || summary.iterations > 1;
  const bool has_failed = reason == StopReason::rank_deficient || reason == StopReason::no_progress ||
                          reason == StopReason::not_finite;
  return has_failed && has_moved;
}

void Restart::begin(StopReason reason, const Summary& summary) {
  end_.emplace(evaluator_.problem());
  first_ = reason;
  first_rss_ = summary.final_rss;
  failed_at_ = summary.iterations;
  start_.restore();
}

bool Restart::hasSucceeded(StopReason second, double rss) {
  const bool is_worse = rss > first_rss_ + Evaluator::kNoise * first_rss_;
  if (!isConverged(second) || is_worse) return false;
  Eigen::VectorXd ignored;
  evaluator_.linearize();
  return evaluator_.solveUndamped(ignored).ok;
}

std::string Restart::warning() const {
  return "iteration " + std::to_string(failed_at_) + ": " + toString(first_) +
         "; the fit began again from the start with short steps of Levenberg-Marquardt";
}

StopReason Restart::settle(StopReason second, double& rss) {
  if (rss < first_rss_) return isConverged(second) ? first_ : second;  // better values, but without full rank
  end_->restore();
  rss = first_rss_;
  return first_;
}

}  // namespace slom
