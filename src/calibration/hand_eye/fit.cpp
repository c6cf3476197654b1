#include "calibration/hand_eye/fit.hpp"

#include <cmath>

#include "calibration/hand_eye/measurements.hpp"

namespace slom::calibration {
namespace {

/// The distance from values along directions, in units of a small standard deviation.
struct HeldResidual {
  HandEyeValues from;
  Direction direction;  ///< divided by the units
  auto operator()(const auto& X, const auto& shift, const auto& scale) const {
    const auto turn = turnVector(from.hand_T_camera.orient.inverse() * X.orient);
    auto sum = direction[0] * (X.pos[0] - from.hand_T_camera.pos[0]) + direction[3] * turn[0];
    for (int k = 1; k < 3; ++k)
      sum = sum + direction[k] * (X.pos[k] - from.hand_T_camera.pos[k]) + direction[3 + k] * turn[k];
    return mtk::vector(sum + direction[6] * (shift.value() - from.shift) +
                       direction[7] * (scale.value() - from.scale));
  }
};

template <bool kInterpolatesHand>
Residual residualOf(const Streams& streams, const HandEyeSettings& settings, const RowPair& item,
                    const HandEyeValues& values) {
  const mtk::Scalar<> shift = values.shift, scale = values.scale;
  const RowPoses<kInterpolatesHand> from(streams, item.from), to(streams, item.to);
  if (settings.drifting)
    return MotionResidual<kInterpolatesHand>{from, to}(values.hand_T_camera, shift, scale);
  return PoseResidual<kInterpolatesHand>{from}(values.hand_T_camera, values.base_T_target, shift, scale);
}

}  // namespace

HandEyeProblem::HandEyeProblem(const Streams& streams, const HandEyeSettings& settings,
                               const HandEyeValues& start, const HandEyeNoise& noise)
    : streams_(streams), settings_(settings), noise_(noise) {
  X = est_.insertRV(start.hand_T_camera, true, "hand_T_camera");
  Y = est_.insertRV(start.base_T_target, !settings.drifting, "base_T_target");
  shift =
      est_.insertRV(mtk::Scalar<>(start.shift), settings.estimate_offset && !settings.pairs, "time_offset");
  scale = est_.insertRV(mtk::Scalar<>(start.scale), settings.estimate_scale, "scale");
  est_.changeAlgorithm(LevenbergMarquardt());
}

template <bool kInterpolatesHand>
void HandEyeProblem::insertItem(const RowPair& item, const Loss& loss, std::int64_t block) {
  const RowPoses<kInterpolatesHand> from(streams_, item.from), to(streams_, item.to);
  const Covariance noise(noise_.covariance);
  const Group time = group("time", block);
  if (settings_.drifting)
    est_.insertMeasurement(MotionResidual<kInterpolatesHand>{from, to}, X, shift, scale, noise, loss,
                           named("motion"), time);
  else
    est_.insertMeasurement(PoseResidual<kInterpolatesHand>{from}, X, Y, shift, scale, noise, loss,
                           named("pose"), time);
}

void HandEyeProblem::insert(const Items& items, const Loss& loss, double block_s) {
  for (const RowPair& item : items) {
    const auto block = std::int64_t(std::floor(streams_.rows[item.from].t_s / block_s));
    if (streams_.interpolates_hand)
      insertItem<true>(item, loss, block);
    else
      insertItem<false>(item, loss, block);
  }
}

void HandEyeProblem::hold(const Held& held) {
  constexpr double firm = 1e-4;  // of the unit, in which noise is about 1
  for (const Direction& direction : held.directions) {
    HandEyeValues from = values();
    // A translation along an axis is held at 0, others where they are.
    const Direction scaled = direction.cwiseQuotient(held.unit);
    if (const double along = direction.head<3>().squaredNorm(); along > 0.9) from.hand_T_camera.pos.setZero();
    est_.insertMeasurement(HeldResidual{from, scaled}, X, shift, scale, StandardDeviation(firm),
                           named("held"));
  }
}

Summary HandEyeProblem::optimize() {
  Options options;
  options.deviation_tolerance = 1e-2;  // interpolated poses have kinks, so the RSS is not smooth below
  options.max_iterations = 100;
  return est_.optimize(options);
}

HandEyeValues HandEyeProblem::values() const { return {*X, *Y, *shift, *scale}; }

std::vector<Residual> residualsAt(const Streams& streams, const HandEyeSettings& settings, const Items& items,
                                  const HandEyeValues& values) {
  std::vector<Residual> residuals;
  residuals.reserve(items.size());
  for (const RowPair& item : items)
    residuals.push_back(streams.interpolates_hand ? residualOf<true>(streams, settings, item, values)
                                                  : residualOf<false>(streams, settings, item, values));
  return residuals;
}

}  // namespace slom::calibration
