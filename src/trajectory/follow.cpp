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

/// Options of one round, which ends when a measurement leaves its segment.
class Round {
 public:
  Round(const Options& given, const std::vector<SplineBase>& splines, int iterations, double seconds)
      : options(given) {
    if (given.max_iterations != Options::kByTheSize) {
      options.max_iterations = std::max(given.max_iterations - iterations, 0);
    }
    options.max_seconds = std::max(given.max_seconds - seconds, 0.0);
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
  std::vector<SplineBase> all(splines);
  followAll(est, all);
  Summary summary;
  double initial_rss = 0, seconds = 0;
  int iterations = 0, moved = 1;
  for (int round = 0; moved > 0 && round < kMostRounds; ++round) {
    Round one(options, all, iterations, seconds);
    summary = est.optimize(one.options);
    if (round == 0) initial_rss = summary.initial_rss;
    iterations += summary.iterations;
    seconds += summary.seconds;
    moved = followAll(est, all);
    if (one.is_stopped || summary.stop_reason == StopReason::max_iterations ||
        summary.stop_reason == StopReason::time_limit) {
      break;
    }
  }
  summary.initial_rss = initial_rss;
  summary.iterations = iterations;
  summary.seconds = seconds;
  if (moved > 0) {
    summary.converged = false;
    summary.message +=
        "; " + std::to_string(moved) + " measurements have just moved to another segment of a spline";
  }
  return summary;
}

}  // namespace slom::trajectory
