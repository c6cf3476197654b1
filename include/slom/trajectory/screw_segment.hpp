/// ScrewSegment: one segment of a cumulative B-spline on SE(3). From one control point to the next leads a screw
/// motion.
///   T(t) = C_0 exp(b_1(t) d_1) ... exp(b_{N-1}(t) d_{N-1})    with d_j = log(C_{j-1}^-1 C_j)
/// The rotations are those of RotationSegment. If another frame is fixed to the body, the curve is still the same
/// motion; that of a PoseSegment is another one. Frames are as in PoseSegment.
///   source  Lovegrove, Patron-Perez and Sibley, "Spline Fusion", 2013; recursions: Sommer et al., "Efficient
///           derivative computation for cumulative B-splines on Lie groups", 2020
#pragma once

#include <array>

#include "slom/trajectory/rotation_segment.hpp"
#include "slom/trajectory/screw.hpp"

namespace slom::trajectory {

/// A twist and its derivative by time, in the frame of the body.
template <class S>
struct ScrewMotion {
  Twist<S> velocity, acceleration;
};

/// The N control points of a segment on SE(3), of numbers S. Times may be of another number type than S.
template <int N, class S = double>
class ScrewSegment {
 public:
  static constexpr int order = N;
  using Control = mtk::trafo<mtk::SO3<S>>;
  using Controls = std::array<Control, std::size_t{N}>;
  /// This segment over another number type.
  template <class T>
  using Over = ScrewSegment<N, T>;

  /// Joins control points and weights.
  ScrewSegment(const Blending<N>& blending, const Controls& controls)
      : blending_(blending), first_(controls[0]), rotation_(blending, detail::orientationsOf(controls)) {
    for (std::size_t j = 0; j < blending_.steps; ++j) {
      steps_[j] = detail::screwLog<S>(controls[j].inverse() * controls[j + 1]);
    }
  }

  /// Returns the weights of the segment.
  const Blending<N>& blending() const { return blending_; }
  /// Returns world_T_body at the time t.
  template <class Time>
  auto poseAt(const Time& t) const {
    const auto b = blending_.at(t);
    mtk::trafo<mtk::SO3<Sum<decltype(b[0])>>> T(first_);
    for (std::size_t j = 0; j < blending_.steps; ++j) T = T * step(b[j], j);
    return T;
  }
  /// Returns the velocity as a twist in the frame of the body: T^-1 dT/dt.
  template <class Time>
  auto twistAt(const Time& t) const {
    const auto b = blending_.at(t), rate = blending_.template at<1>(t);
    auto velocity = steps_[0].times(rate[0]);
    for (std::size_t j = 1; j < blending_.steps; ++j) {
      velocity = detail::seenAfter(step(b[j], j), velocity).plus(steps_[j].times(rate[j]));
    }
    return velocity;
  }
  /// Returns the twist and its derivative by time.
  template <class Time>
  auto screwMotionAt(const Time& t) const {
    const auto b = blending_.at(t), rate = blending_.template at<1>(t),
               curvature = blending_.template at<2>(t);
    ScrewMotion<Sum<decltype(b[0])>> motion{steps_[0].times(rate[0]), steps_[0].times(curvature[0])};
    for (std::size_t j = 1; j < blending_.steps; ++j) {
      const auto T = step(b[j], j);
      const auto added = steps_[j].times(rate[j]);
      const auto carried = detail::seenAfter(T, motion.velocity);
      motion.velocity = carried.plus(added);
      motion.acceleration = detail::seenAfter(T, motion.acceleration)
                                .plus(detail::bracket(carried, added))
                                .plus(steps_[j].times(curvature[j]));
    }
    return motion;
  }

  /// Returns the position of the body in the world.
  template <class Time>
  auto positionAt(const Time& t) const {
    return poseAt(t).pos;
  }
  /// Returns the rotation from the body to the world.
  template <class Time>
  auto orientationAt(const Time& t) const {
    return rotation_.orientationAt(t);
  }
  /// Returns the derivative of the position by time, along the axes of the world.
  template <class Time>
  auto velocityAt(const Time& t) const {
    return orientationAt(t) * bodyVelocityAt(t);
  }
  /// Returns the second derivative of the position by time, along the axes of the world.
  template <class Time>
  auto accelerationAt(const Time& t) const {
    return orientationAt(t) * bodyAccelerationAt(t);
  }
  /// Returns the velocity along the axes of the body.
  template <class Time>
  auto bodyVelocityAt(const Time& t) const {
    return twistAt(t).linear;
  }
  /// Returns the acceleration along the axes of the body. An accelerometer in the origin of the body reads this vector
  /// minus gravity along the same axes.
  template <class Time>
  auto bodyAccelerationAt(const Time& t) const {
    const auto motion = screwMotionAt(t);
    return motion.acceleration.linear + detail::cross(motion.velocity.angular, motion.velocity.linear);
  }
  /// Returns the angular velocity in the frame of the body, as a gyroscope reads it.
  template <class Time>
  auto angularVelocityAt(const Time& t) const {
    return rotation_.angularVelocityAt(t);
  }
  /// Returns the derivative by time of angularVelocityAt, in the frame of the body.
  template <class Time>
  auto angularAccelerationAt(const Time& t) const {
    return rotation_.angularAccelerationAt(t);
  }
  /// Returns the angular velocity along the axes of the world.
  template <class Time>
  auto worldAngularVelocityAt(const Time& t) const {
    return rotation_.worldAngularVelocityAt(t);
  }
  /// Returns the angular acceleration along the axes of the world.
  template <class Time>
  auto worldAngularAccelerationAt(const Time& t) const {
    return rotation_.worldAngularAccelerationAt(t);
  }

 private:
  template <class T>
  using Sum = mtk::promote_t<S, std::remove_cvref_t<T>>;

  /// Returns exp(weight * d_{j+1}).
  template <class T>
  auto step(const T& weight, std::size_t j) const {
    return detail::screwExp<Sum<T>>(steps_[j].times(weight));
  }

  Blending<N> blending_;
  Control first_;
  std::array<Twist<S>, std::size_t{N - 1}> steps_;
  RotationSegment<N, S> rotation_;
};

}  // namespace slom::trajectory
