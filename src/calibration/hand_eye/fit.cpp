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
    const auto turn = detail::rotationVector(from.hand_T_camera.orient.inverse() * X.orient);
    auto sum = direction[0] * (X.pos[0] - from.hand_T_camera.pos[0]) + direction[3] * turn[0];
    for (int k = 1; k < 3; ++k)
      sum = sum + direction[k] * (X.pos[k] - from.hand_T_camera.pos[k]) + direction[3 + k] * turn[k];
    return mtk::vector(sum + direction[6] * (shift.value() - from.shift) + direction[7] * (scale.value() - from.scale));
  }
};

template <bool kInterpolatesHand>
void writeResiduals(const Streams& streams, const HandEyeSettings& settings, const Items& items,
                    const HandEyeValues& values, Eigen::VectorXd& out) {
  const SE3 &X = values.hand_T_camera, &Y = values.base_T_target;
  const mtk::Scalar<> shift = values.shift, scale = values.scale;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const RowPoses<kInterpolatesHand> from(streams, items[i].from), to(streams, items[i].to);
    auto rotation = out.segment<3>(6 * Eigen::Index(i)), translation = out.segment<3>(6 * Eigen::Index(i) + 3);
    if (settings.drifting) {
      rotation = TurnResidual<kInterpolatesHand>{from, to}(X, shift);
      translation = MoveResidual<kInterpolatesHand>{from, to}(X, shift, scale);
    } else {
      rotation = RotationResidual<kInterpolatesHand>{from}(X, Y, shift);
      translation = PositionResidual<kInterpolatesHand>{from}(X, Y, shift, scale);
    }
  }
}

}  // namespace

HandEyeProblem::HandEyeProblem(const Streams& streams, const HandEyeSettings& settings,
                               const HandEyeValues& start, const HandEyeNoise& noise)
    : streams_(streams), settings_(settings), noise_(noise) {
  X = est_.insertRV(start.hand_T_camera, true, "hand_T_camera");
  Y = est_.insertRV(start.base_T_target, !settings.drifting, "base_T_target");
  shift = est_.insertRV(mtk::Scalar<>(start.shift), settings.estimate_offset && !settings.pairs, "time_offset");
  scale = est_.insertRV(mtk::Scalar<>(start.scale), settings.estimate_scale, "scale");
  est_.changeAlgorithm(LevenbergMarquardt());
}

template <bool kInterpolatesHand>
void HandEyeProblem::insertItem(const RowPair& item, const Loss& loss, std::int64_t block) {
  const RowPoses<kInterpolatesHand> from(streams_, item.from), to(streams_, item.to);
  const StandardDeviation rotation(noise_.rotation_rad), translation(noise_.translation_m);
  const Group time = group("time", block);
  if (settings_.drifting) {
    est_.insertMeasurement(TurnResidual<kInterpolatesHand>{from, to}, X, shift, rotation, loss, named("rotation"), time);
    est_.insertMeasurement(MoveResidual<kInterpolatesHand>{from, to}, X, shift, scale, translation, loss,
                           named("translation"), time);
  } else {
    est_.insertMeasurement(RotationResidual<kInterpolatesHand>{from}, X, Y, shift, rotation, loss, named("rotation"),
                           time);
    est_.insertMeasurement(PositionResidual<kInterpolatesHand>{from}, X, Y, shift, scale, translation, loss,
                           named("translation"), time);
  }
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
    est_.insertMeasurement(HeldResidual{from, scaled}, X, shift, scale, StandardDeviation(firm), named("held"));
  }
}

Summary HandEyeProblem::optimize() {
  Options options;
  options.deviation_tolerance = 1e-5;
  return est_.optimize(options);
}

HandEyeValues HandEyeProblem::values() const { return {*X, *Y, *shift, *scale}; }

Eigen::VectorXd residualsAt(const Streams& streams, const HandEyeSettings& settings, const Items& items,
                            const HandEyeValues& values) {
  Eigen::VectorXd residuals(6 * Eigen::Index(items.size()));
  if (streams.interpolates_hand)
    writeResiduals<true>(streams, settings, items, values, residuals);
  else
    writeResiduals<false>(streams, settings, items, values, residuals);
  return residuals;
}

std::vector<Misfit> misfitsOf(const Eigen::VectorXd& residuals) {
  std::vector<Misfit> misfits;
  for (Eigen::Index i = 0; i < residuals.size(); i += 6)
    misfits.push_back({residuals.segment<3>(i).norm(), residuals.segment<3>(i + 3).norm()});
  return misfits;
}

}  // namespace slom::calibration
