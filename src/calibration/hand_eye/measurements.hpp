// The residuals of hand and eye, for numbers with derivatives.
#pragma once

#include <type_traits>

#include "calibration/hand_eye/streams.hpp"

namespace slom::calibration {

/// Both poses of a row at a shift. One of them is interpolated, so it depends on the shift.
template <bool kInterpolatesHand>
class RowPoses {
 public:
  RowPoses(const Streams& streams, std::size_t row) : streams_(&streams), row_(&streams.rows[row]) {}

  auto hand(const auto& shift) const {
    if constexpr (kInterpolatesHand) return streams_->hand.at(row_->t_s + shift);
    else return own();
  }
  auto camera(const auto& shift) const {
    if constexpr (kInterpolatesHand) return own();
    else return streams_->camera.at(row_->t_s - shift);
  }

 private:
  PoseAt<SO3, vec3> own() const { return {row_->pose.orient, row_->pose.pos}; }

  const Streams* streams_;
  const StampedPose* row_;
};

namespace detail {
auto rotationVector(const auto& R) { return std::remove_cvref_t<decltype(R)>::log(R); }
/// Returns the number without the type of a variable.
const auto& numberIn(const auto& x) { return x.value(); }
}  // namespace detail

/// The rotation from base_R_target target_R_camera to base_R_hand hand_R_camera, 3 [rad].
template <bool kInterpolatesHand>
struct RotationResidual {
  RowPoses<kInterpolatesHand> poses;
  auto operator()(const auto& X, const auto& Y, const auto& shift) const {
    const auto hand = poses.hand(detail::numberIn(shift));
    const auto camera = poses.camera(detail::numberIn(shift));
    const auto by_camera = Y.orient * camera.orient;
    const auto by_hand = hand.orient * X.orient;
    return detail::rotationVector(by_camera.inverse() * by_hand);
  }
};

/// The position of the camera in the base by the hand, minus that by the target, 3 [m].
template <bool kInterpolatesHand>
struct PositionResidual {
  RowPoses<kInterpolatesHand> poses;
  auto operator()(const auto& X, const auto& Y, const auto& shift, const auto& scale) const {
    const auto hand = poses.hand(detail::numberIn(shift));
    const auto camera = poses.camera(detail::numberIn(shift));
    const auto by_hand = (hand.orient * X.pos + hand.pos).eval();
    const auto by_camera = (Y.orient * (camera.pos * detail::numberIn(scale)) + Y.pos).eval();
    return (by_hand - by_camera).eval();
  }
};

/// The rotation from A X to X B for a motion A of the hand and B of the camera, 3 [rad].
template <bool kInterpolatesHand>
struct TurnResidual {
  RowPoses<kInterpolatesHand> from, to;
  auto operator()(const auto& X, const auto& shift) const {
    const auto hand_a = from.hand(detail::numberIn(shift)), hand_b = to.hand(detail::numberIn(shift));
    const auto camera_a = from.camera(detail::numberIn(shift)), camera_b = to.camera(detail::numberIn(shift));
    const auto A = hand_a.orient.inverse() * hand_b.orient;
    const auto B = camera_a.orient.inverse() * camera_b.orient;
    const auto by_camera = X.orient * B;
    return detail::rotationVector(by_camera.inverse() * (A * X.orient));
  }
};

/// The translation of A X minus that of X B, 3 [m].
template <bool kInterpolatesHand>
struct MoveResidual {
  RowPoses<kInterpolatesHand> from, to;
  auto operator()(const auto& X, const auto& shift, const auto& scale) const {
    const auto hand_a = from.hand(detail::numberIn(shift)), hand_b = to.hand(detail::numberIn(shift));
    const auto camera_a = from.camera(detail::numberIn(shift)), camera_b = to.camera(detail::numberIn(shift));
    const auto back = hand_a.orient.inverse();
    const auto turn = back * hand_b.orient;
    const auto move = (back * (hand_b.pos - hand_a.pos)).eval();
    const auto seen = (camera_a.orient.inverse() * (camera_b.pos - camera_a.pos)).eval();
    const auto by_hand = (turn * X.pos + move).eval();
    const auto by_camera = (X.orient * (seen * detail::numberIn(scale)) + X.pos).eval();
    return (by_hand - by_camera).eval();
  }
};

}  // namespace slom::calibration
