#include "online/online_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/index.hpp"

namespace slom {

namespace {

/// Relative difference between a Jacobian and the one in the factor above which the factor gets the new Jacobian. The
/// second limit applies after a step that achieved less than the fraction kKeptOnline of its predicted decrease.
constexpr double kStaleOnline = 3e-4, kSlightlyStale = 1e-4;
constexpr double kKeptOnline = 0.5;
/// Smallest predicted decrease for which a subtree is moved, relative to the decrease that may be left in total. The
/// remainders of hundreds of subtrees add up, and another step costs more than moving some subtrees unnecessarily.
constexpr double kShareOnline = 3e-3, kSmallerShare = 0.1;
/// Fraction of the allowed decrease that is the target, because the predicted decrease is that of a model.
constexpr double kAimedAt = 0.5;
constexpr double kSlowest = 0.99;  // ratio of the predicted decreases of two steps
constexpr double kNoiseOfRss = 1e-13;
/// Largest decrease that rounding errors may hide, in squared standard deviations. One very exact measurement may make
/// rounding errors worth more, but other measurements then are not.
constexpr double kMostRoundingOnline = 1e-4;
/// Number of steps after which values may differ in size from those at insertion of their measurements.
constexpr int kManySteps = 3;
/// Fraction of the RSS above which a predicted decrease shows that the optimum is far off. Then optimize() chooses the
/// minimum.
constexpr double kFarOff = 0.5;
bool isFarOff(double promised, double rss) { return promised >= kFarOff * rss; }
/// Ratio of a step's decrease to the predicted one above which the step is lengthened, and the largest factor.
constexpr double kStretched = 1.5, kLongest = 8;
/// Factor by which an uphill step is shortened, and fraction of its length down to which it is.
constexpr double kShorterOnline = 0.5, kShortestOnline = 0.1;

}  // namespace

/// Stores a step and the measurements that it touches.
void OnlineFit::prepare(const std::vector<IncrementalCholesky::Move>& moves) {
  moved_variables_.clear();
  step_.clear();
  touched_.clear();
  ++visit_;
  for (const auto& [block, d] : moves) {
    moved_variables_.push_back(block);
    step_.insert(step_.end(), d, d + factor_.dof(block));
    touchUsesOf(block);
  }
  std::sort(touched_.begin(), touched_.end());
  moved_ += static_cast<int>(moves.size());
}

/// Moves by a multiple of the last step.
void OnlineFit::moveBy(double factor) {
  const double* d = step_.data();
  std::vector<double> part;
  for (const int v : moved_variables_) {
    part.assign(d, d + factor_.dof(v));
    for (double& x : part) x *= factor;
    if (trial_) trial_->keep(v);
    problem_.move(v, part.data());
    d += factor_.dof(v);
  }
  value_revision_ = problem_.valueRevision();
}

/// Linearises at the end of a step. Returns whether the RSS is at most `most`.
bool OnlineFit::isBelow(double most) {
  try {
    linearizeTouched(kStaleOnline);
    return rss() <= most;
  } catch (const Error&) {  // no residuals there
    return false;
  }
}

/// Takes the step, or a part or a multiple of it, so that the RSS falls. If the RSS does not fall, the values stay, and
/// the factor gets their Jacobians.
bool OnlineFit::go(double promised) {
  // With first estimates, the gradient is not that of the RSS. On a step to the gradient's root, the RSS may rise by up
  // to the predicted decrease.
  const bool is_exact = problem_.firstEstimates().isEmpty();
  const double before = rss(), most = before + (is_exact ? kNoiseOfRss * before : promised);
  moveBy(1);
  if (isBelow(most)) {
    if (is_exact) stretch(before, promised);
    return true;
  }
  double length = 1;
  while (!isFarOff(promised, before) && length * kShorterOnline > kShortestOnline) {
    moveBy((kShorterOnline - 1) * length);
    length *= kShorterOnline;
    if (isBelow(most)) return true;
  }
  moveBy(-length);
  linearizeTouched(0);
  return false;
}

/// Moves to the minimum of the parabola through the predicted and the actual decrease. If the RSS fell by more than
/// predicted, this lengthens the step; for example, losses make the curvature smaller than in the factor. If it fell by
/// less, this shortens the step; for example, large residuals make the curvature larger.
void OnlineFit::stretch(double before, double promised) {
  const double after = rss(), ratio = (before - after) / promised;
  if (ratio > kKeptOnline && ratio < kStretched) return;
  const double more = (2 - ratio) * kLongest > 1 ? 1 / (2 - ratio) - 1 : kLongest - 1;
  moveBy(more);
  if (isBelow(after)) return;
  moveBy(-more);
  linearizeTouched(kStaleOnline);
}

bool OnlineFit::run(const UpdateOptions& options, UpdateSummary& summary) {
  is_at_end_ = false;
  try {
    is_at_end_ = stepToTolerance(options, summary);
    return is_at_end_;
  } catch (...) {  // an interrupted follow() is incomplete
    has_started_ = false;
    throw;
  }
}

bool OnlineFit::stepToTolerance(const UpdateOptions& options, UpdateSummary& summary) {
  linearized_ = moved_ = steps_ = 0;
  flops_ = 0;
  factor_.resetWork();
  follow(options.reconsider);
  factor_.refactor();
  const std::size_t free_at_start = factor_.undetermined().size();
  End end = descend(options);
  // Steps may have led to values at which an unknown has no influence: a saddle or a plateau, which optimize() leaves.
  if (end == End::near && factor_.undetermined().size() > free_at_start) end = End::stuck;
  std::erase_if(waiting_,
                [&](const Trial& trial) { return !problem_.pools()[at(trial.pool)]->has(trial.ref); });
  if (options.reconsider && end == End::near) end = reconsiderAll(options, summary);
  summary.waiting = static_cast<int>(waiting_.size());
  summary.is_put_off = end == End::put_off;
  is_done_everywhere_ = end == End::near;
  fill(summary, end == End::near);
  if (end != End::stuck) return true;
  summary.needs_optimize = std::isfinite(options.budget);
  return summary.needs_optimize;
}

/// Steps until the tolerance is met or a step fails, within the limits of the options and of this call.
OnlineFit::End OnlineFit::descend(const UpdateOptions& options) {
  double share = kShareOnline;
  // Predicted decrease of all further steps together, relative to the next step. Above 1 if convergence is slow.
  double slowness = 1;
  bool is_fresh = false;  // the factor has the Jacobians of the current values where it last moved
  for (int steps = 0;; ++steps) {
    sumAgain();
    const double before = rss(), promised = factor_.promise();
    // Below the measurements' rounding errors, no optimum can be found.
    const double allowed = std::max({options.tolerance * before, std::min(rounding_, kMostRoundingOnline),
                                     std::numeric_limits<double>::min()});
    const bool is_near = promised * slowness <= kAimedAt * allowed;
    if (is_near) return End::near;
    if (steps > 0 && flops() >= options.budget) return End::put_off;
    if (steps_ >= options.max_steps) return End::max_steps;
    prepare(factor_.solve(share * allowed, steps > 0 || !is_done_everywhere_));
    if (steps >= kManySteps) {
      for (const Place& place : touched_) roundAgain(recordOf(place));
    }
    ++steps_;
    if (!go(promised)) {
      factor_.refactor();
      if (is_fresh || isFarOff(promised, before)) return End::stuck;
      is_fresh = true;
      continue;
    }
    const double decrease = before - rss();
    is_fresh = decrease < kKeptOnline * promised;
    if (is_fresh) {
      linearizeTouched(kSlightlyStale);
      share *= kSmallerShare;
    }
    factor_.refactor();
    slowness = std::max(1.0, decrease / promised) / (1 - std::min(kSlowest, factor_.promise() / promised));
  }
}

void OnlineFit::fill(UpdateSummary& summary, bool converged) const {
  const IncrementalCholesky::Work& work = factor_.work();
  summary.converged = converged;
  summary.rss = rss();
  summary.promise = factor_.promise();
  summary.steps += steps_;
  summary.variables_moved += moved_;
  summary.measurements_linearized += linearized_;
  summary.fronts_factorized += work.fronts_factorized;
  summary.fronts_solved += work.fronts_solved;
  summary.flops += flops();
  summary.reordered = summary.reordered || work.reordered_all;
  summary.undetermined.clear();
  for (const auto& [variable, component] : factor_.undetermined()) {
    if (!problem_.activeSet().isFixedOrActive(variable, component))
      summary.undetermined.push_back(problem_.componentNames(variable)[at(component)]);
  }
}

}  // namespace slom
