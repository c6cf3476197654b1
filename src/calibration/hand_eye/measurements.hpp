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
    if constexpr (kInterpolatesHand)
      return streams_->hand.at(row_->t_s + shift);
    else
      return own();
  }
  auto camera(const auto& shift) const {
    if constexpr (kInterpolatesHand)
      return own();
    else
      return streams_->camera.at(row_->t_s - shift);
  }

 private:
  PoseAt<SO3, vec3> own() const { return {row_->pose.orient, row_->pose.pos}; }

  const Streams* streams_;
  const StampedPose* row_;
};

/// Returns the rotation vector of a rotation of any number type.
auto turnVector(const auto& R) { return std::remove_cvref_t<decltype(R)>::log(R); }
/// Returns the number without the type of a variable.
const auto& numberIn(const auto& x) { return x.value(); }

/// The camera by the target, as seen from the camera by the hand, (hand_T_camera^-1 base_T_hand^-1) base_T_target
/// target_T_camera: translation [unit of the camera's stream] and rotation vector [rad], both along the axes of the
/// camera. In the unit of the camera, because most of the noise is its: a scale that also shrinks noise comes out too small.
template <bool kInterpolatesHand>
struct PoseResidual {
  RowPoses<kInterpolatesHand> poses;
  auto operator()(const auto& X, const auto& Y, const auto& shift, const auto& scale) const {
    const auto hand = poses.hand(numberIn(shift));
    const auto camera = poses.camera(numberIn(shift));
    const auto back = (hand.orient * X.orient).inverse();
    const auto by_hand = (hand.orient * X.pos + hand.pos).eval();
    const auto by_target = (Y.orient * (camera.pos * numberIn(scale)) + Y.pos).eval();
    const auto move = (back * (by_target - by_hand) / numberIn(scale)).eval();
    const auto turn = turnVector(back * (Y.orient * camera.orient));
    return mtk::vector(move[0], move[1], move[2], turn[0], turn[1], turn[2]);
  }
};

/// The same of a motion A of the hand and B of the camera, (A X)^-1 X B.
template <bool kInterpolatesHand>
struct MotionResidual {
  RowPoses<kInterpolatesHand> from, to;
  auto operator()(const auto& X, const auto& shift, const auto& scale) const {
    const auto hand_a = from.hand(numberIn(shift)), hand_b = to.hand(numberIn(shift));
    const auto camera_a = from.camera(numberIn(shift)), camera_b = to.camera(numberIn(shift));
    const auto hand_back = hand_a.orient.inverse();
    const auto camera_back = camera_a.orient.inverse();
    const auto A = hand_back * hand_b.orient;
    const auto by_hand = (A * X.pos + hand_back * (hand_b.pos - hand_a.pos)).eval();
    const auto seen = (camera_back * (camera_b.pos - camera_a.pos)).eval();
    const auto by_camera = (X.orient * (seen * numberIn(scale)) + X.pos).eval();
    const auto back = (A * X.orient).inverse();
    const auto move = (back * (by_camera - by_hand) / numberIn(scale)).eval();
    const auto turn = turnVector(back * (X.orient * (camera_back * camera_b.orient)));
    return mtk::vector(move[0], move[1], move[2], turn[0], turn[1], turn[2]);
  }
};

}  // namespace slom::calibration
