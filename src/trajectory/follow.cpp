#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "slom/trajectory/measurement.hpp"

namespace slom::trajectory {

namespace {

/// Rounds of a fit. Each moves measurements, so this many mean that a time goes back and forth, or far away.
constexpr int kMostRounds = 1000;

bool anyIsLeft(const std::vector<SplineBase>& splines) {
  return std::any_of(splines.begin(), splines.end(),
                     [](const SplineBase& spline) { return spline.isLeft(); });
}
int followAll(Estimator& est, std::vector<SplineBase>& splines) {
  int moved = 0;
  for (SplineBase& spline : splines) moved += spline.follow(est);
  return moved;
}

/// Options of one round, which ends when a measurement leaves its segment. Earlier rounds, described by `before`, count
/// towards the limits.
class Round {
 public:
  Round(const Options& given, const std::vector<SplineBase>& splines, const Summary* before)
      : options(given) {
    if (before != nullptr && given.max_iterations != Options::kByTheSize) {
      options.max_iterations = std::max(given.max_iterations - before->iterations, 0);
    }
    if (before != nullptr) options.max_seconds = std::max(given.max_seconds - before->seconds, kLeastSeconds);
    if (given.should_stop) {
      options.should_stop = [this, &given] { return is_stopped = is_stopped || given.should_stop(); };
    }
    options.observer = [this, &given, &splines](const IterationRecord& record) {
      if (given.observer && given.observer(record) == FitControl::stop) {
        is_stopped = true;
        return FitControl::stop;
      }
      // If the fit ends, it returns to the best values. So it ends only at better ones than before.
      const bool is_better = record.rss < least_rss_;
      least_rss_ = std::min(least_rss_, record.rss);
      return record.iteration > 0 && is_better && anyIsLeft(splines) ? FitControl::stop : FitControl::go_on;
    };
  }

  Options options;
  bool is_stopped = false;  ///< by the user

 private:
  static constexpr double kLeastSeconds = 1e-9;  // 0 is no limit that a fit accepts
  double least_rss_ = std::numeric_limits<double>::infinity();
};

}  // namespace

bool SplineBase::isLeft() const {
  return std::any_of(state_->moving.begin(), state_->moving.end(),
                     [](const auto& measurement) { return measurement->exists() && measurement->isAway(); });
}

int SplineBase::follow(Estimator& est) {
  std::erase_if(state_->moving, [](const auto& measurement) { return !measurement->exists(); });
  int moved = 0;
  for (const auto& measurement : state_->moving) {
    if (!measurement->isAway()) continue;
    measurement->place(est);
    ++moved;
  }
  if (std::exchange(state_->has_changed, false)) {
    state_->trim(est);
    state_->tieEnds(est, false);
  }
  return moved;
}

Summary optimize(Estimator& est, std::initializer_list<SplineBase> splines, const Options& options) {
  return optimize(est, std::vector<SplineBase>(splines), options);
}

Summary optimize(Estimator& est, const std::vector<SplineBase>& splines, const Options& options) {
  std::vector<SplineBase> all(splines);
  followAll(est, all);
  Summary summary;
  int moved = 1;
  for (int round = 0; moved > 0 && round < kMostRounds; ++round) {
    Round one(options, all, round > 0 ? &summary : nullptr);
    Summary last = est.optimize(one.options);
    if (round > 0) {
      last.initial_rss = summary.initial_rss;
      last.iterations += summary.iterations;
      last.seconds += summary.seconds;
    }
    summary = std::move(last);
    moved = followAll(est, all);
    const StopReason reason = summary.stop_reason;
    if (one.is_stopped || reason == StopReason::max_iterations || reason == StopReason::time_limit) break;
  }
  if (moved > 0) {
    summary.converged = false;
    summary.message +=
        "; " + std::to_string(moved) + " measurements have just moved to another segment of a spline";
  }
  return summary;
}

}  // namespace slom::trajectory
