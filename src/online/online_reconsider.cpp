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

/// Tries it; whether the RSS is lower. The values are those of the trial in any case.
bool OnlineFit::isBetterWith(Place place, double graduation, const UpdateOptions& options) {
  const double most = rss() - kBetter * recordOf(place).cost;
  UpdateOptions roughly = options;
  roughly.max_steps = kTrialSteps;
  roughly.tolerance = std::max(options.tolerance, kTrialTolerance);
  setGraduation(place, graduation);
  const bool is_stuck = descend(roughly) == End::stuck;
  const double others = rss() - recordOf(place).cost;
  setGraduation(place, 1);
  if (is_stuck || others >= most) return false;  // even where it agrees, the others lose more than it gains
  return descend(options) == End::near && rss() < most;
}

OnlineFit::End OnlineFit::reconsider(Place place, const UpdateOptions& options, UpdateSummary& summary) {
  const Loss& loss = *problem_.pools()[at(place.first)]->lossOf(place.second);
  const double s = squaredResidual(place);
  if (loss.evaluate(s).first >= kRefused) return End::near;
  ++summary.reconsidered;
  trial_ = std::make_unique<ValueSnapshot>(problem_, std::initializer_list<int>{});
  bool is_better = false;
  try {
    is_better = isBetterWith(place, s / (kPulling * loss.scale() * loss.scale()), options);
  } catch (...) {
    std::exchange(trial_, nullptr)->restore();
    throw;
  }
  const std::unique_ptr<ValueSnapshot> trial = std::move(trial_);
  if (is_better) {
    ++summary.accepted;
    return End::near;
  }
  trial->restore();
  followMoves();
  factor_.refactor();
  return descend(options);  // the Jacobians are newer than before
}

}  // namespace slom
