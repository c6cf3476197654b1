/// New measurements that their losses refuse: is the map wrong, or are they?
///
/// A loss whose weight falls to nothing leads into the minimum in whose valley the values lie. Where earlier, false measurements have bent the
/// map, it refuses the true ones that come later. Each new one that is refused is tried: with its loss graduated so much that it
/// pulls, steps lead to a map that agrees with it; then with the loss as given to a minimum, which is kept where its RSS is lower.
///   source   Yang, Antonante, Tzoumas and Carlone, "Graduated non-convexity for robust spatial perception", RA-L 2020; McGann, Rogers and
///            Kaess, "Robust incremental smoothing and mapping (riSAM)", ICRA 2023 (graduation of what is new)
#include <algorithm>
#include <initializer_list>
#include <utility>

#include <Eigen/Core>

#include "base/index.hpp"
#include "online/online_fit.hpp"

namespace slom {

namespace {
/// A measurement is refused where its weight is below this.
constexpr double kRefused = 0.1;
/// |W r|^2 / c^2 at which a measurement pulls, by all losses that refuse.
constexpr double kPulling = 0.1;
/// The largest number of steps with the loss graduated, and their tolerance.
constexpr int kTrialSteps = 15;
constexpr double kTrialTolerance = 1e-4;
/// By how much the RSS must be lower, relative to what the refused measurement adds to it. With much more, true ones are refused for good.
constexpr double kBetter = 0.02;
}  // namespace

double OnlineFit::squaredResidual(Place place) const {
  MeasurementPool& pool = *problem_.pools()[at(place.first)];
  Eigen::VectorXd r(pool.rows(place.second));
  problem_.naming(pool, [&] { pool.evaluate(place.second, place.second + 1, r.data()); });
  return r.squaredNorm();
}

void OnlineFit::setGraduation(Place place, double graduation) {
  recordOf(place).graduation = graduation;
  linearize(place, 1, 0);
  factor_.refactor();
}

bool OnlineFit::isRefused(Place place) const {
  const Loss& loss = *problem_.pools()[at(place.first)]->lossOf(place.second);
  return loss.evaluate(squaredResidual(place)).first < kRefused;
}

/// Whether the call may begin no further step.
bool OnlineFit::isExhausted(const UpdateOptions& options) const {
  return flops() >= options.budget || steps_ >= options.max_steps;
}

/// Drops the values of trials that were ended: all, or those of trials with variables that somebody else has moved since.
void OnlineFit::forgetTrialValues(bool all) {
  const auto moves = problem_.movedSince(value_revision_);
  for (Trial& trial : waiting_) {
    if (trial.values == nullptr) continue;
    const auto isGone = [&](int v) { return v == Problem::kAll || trial.values->keeps(v); };
    if (all || !moves || std::any_of(moves->begin(), moves->end(), isGone)) trial.values.reset();
  }
}

bool OnlineFit::mayBegin(const Trial& trial, double operations, int steps) const {
  if (trial.values != nullptr) return operations > 0 && steps > 0;
  return operations > trial.operations && steps > trial.steps;
}

/// Tries it, or goes on with it. The values are those of the trial in any case.
OnlineFit::Verdict OnlineFit::tryIt(Trial& trial, Place place, const UpdateOptions& options) {
  const Loss& loss = *problem_.pools()[at(place.first)]->lossOf(place.second);
  const double graduation = squaredResidual(place) / (kPulling * loss.scale() * loss.scale());
  const double most = rss() - kBetter * recordOf(place).cost;
  if (trial.values != nullptr) {
    for (const int v : trial.values->kept()) trial_->keep(v);
    trial.values->restore();
    followMoves();
    factor_.refactor();
  } else {
    trial.is_graduated = true;
  }
  if (trial.is_graduated) {
    UpdateOptions roughly = options;
    roughly.max_steps = std::min(options.max_steps, steps_ + kTrialSteps);
    roughly.tolerance = std::max(options.tolerance, kTrialTolerance);
    setGraduation(place, graduation);
    const End end = descend(roughly);
    const double others = rss() - recordOf(place).cost;
    setGraduation(place, 1);
    if (end == End::stuck) return Verdict::worse;
    if (end != End::near && isExhausted(options)) return Verdict::unknown;
    trial.is_graduated = false;
    if (others >= most) return Verdict::worse;  // even where it agrees, the others lose more than it gains
    if (isExhausted(options)) return Verdict::unknown;
  }
  const End end = descend(options);
  if (end == End::put_off || end == End::max_steps) return Verdict::unknown;
  return end == End::near && rss() < most ? Verdict::better : Verdict::worse;
}

/// Tries what waits, the oldest first, as long as the call has operations and steps left. What was tried to the end, is no longer refused or
/// was removed waits no longer.
OnlineFit::End OnlineFit::reconsiderAll(const UpdateOptions& options, UpdateSummary& summary) {
  End end = End::near;
  for (Trial& trial : waiting_) {
    const Place place(trial.pool, problem_.pools()[at(trial.pool)]->indexOf(trial.ref));
    const double operations = options.budget - flops();
    const int steps = options.max_steps - steps_;
    if (end != End::near) break;
    trial.is_done = !isRefused(place);
    if (trial.is_done || !mayBegin(trial, operations, steps)) continue;
    end = reconsider(trial, place, options, summary);
    if (flops() >= options.budget) trial.operations = operations;
    if (steps_ >= options.max_steps) trial.steps = steps;
  }
  std::erase_if(waiting_, [](const Trial& trial) { return trial.is_done; });
  return end;
}

/// Tries one, and takes the values back where that is not better.
OnlineFit::End OnlineFit::reconsider(Trial& trial, Place place, const UpdateOptions& options,
                                     UpdateSummary& summary) {
  trial_ = std::make_unique<ValueSnapshot>(problem_, std::initializer_list<int>{});
  Verdict verdict = Verdict::unknown;
  try {
    verdict = tryIt(trial, place, options);
  } catch (...) {
    std::exchange(trial_, nullptr)->restore();
    throw;
  }
  const std::unique_ptr<ValueSnapshot> before = std::move(trial_);
  trial.is_done = verdict != Verdict::unknown;
  if (trial.is_done) ++summary.reconsidered;
  if (verdict == Verdict::better) {
    if (!isRefused(place)) ++summary.accepted;
    return End::near;
  }
  trial.values = trial.is_done ? nullptr : before->takeAgain();
  before->restore();
  followMoves();
  factor_.refactor();
  return descend(options);  // the Jacobians are newer than before
}

}  // namespace slom
