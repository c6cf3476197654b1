/// New measurements that their losses refuse: either the map is wrong, or the measurements are.
///
/// A loss whose weight falls to 0 leads to the minimum of the valley in which the values lie. If earlier, false
/// measurements have bent the map, the loss refuses later, true ones. So each new measurement that is refused is tried
/// in two stages. First its loss is graduated so much that the measurement pulls, and steps lead to a map that agrees
/// with it. Then steps with the original loss lead to a minimum, which is kept if its RSS is lower.
///   source   Yang, Antonante, Tzoumas and Carlone, "Graduated non-convexity for robust spatial perception", RA-L 2020;
///            McGann, Rogers and Kaess, "Robust incremental smoothing and mapping (riSAM)", ICRA 2023 (graduation of new
///            measurements)
#include <algorithm>
#include <initializer_list>
#include <utility>

#include <Eigen/Core>

#include "base/index.hpp"
#include "online/online_fit.hpp"

namespace slom {

namespace {
/// Weight below which a measurement counts as refused.
constexpr double kRefused = 0.1;
/// W r|^2 / c^2 at which a measurement pulls, for all losses that refuse.
constexpr double kPulling = 0.1;
/// Largest number of steps with the graduated loss, and their tolerance.
constexpr int kTrialSteps = 15;
constexpr double kTrialTolerance = 1e-4;
/// Necessary decrease of the RSS, relative to the cost of the refused measurement. A much larger value would refuse
/// true measurements for good.
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

/// Returns whether the call may begin no further step.
bool OnlineFit::isExhausted(const UpdateOptions& options) const {
  return flops() >= options.budget || steps_ >= options.max_steps;
}

/// Drops the values of ended trials: of all trials, or of those with variables that were moved from outside since.
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

/// Tries a measurement, or continues its trial. Leaves the values of the trial, whatever the verdict.
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
    if (others >= most) return Verdict::worse;  // even then, the others lose more than this one gains
    if (isExhausted(options)) return Verdict::unknown;
  }
  const End end = descend(options);
  if (end == End::put_off || end == End::max_steps) return Verdict::unknown;
  return end == End::near && rss() < most ? Verdict::better : Verdict::worse;
}

/// Tries the waiting measurements, oldest first, while the call has operations and steps left. A measurement stops
/// waiting if its trial is complete, if it is no longer refused or if it was removed.
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

/// Tries one measurement, and restores the values if they are not better.
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
