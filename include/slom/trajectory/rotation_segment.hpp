/// RotationSegment: one segment of a cumulative B-spline on SO(3).
///   R(t) = C_0 exp(b_1(t) d_1) ... exp(b_{N-1}(t) d_{N-1})    with d_j = log(C_{j-1}^-1 C_j)
/// R moves vectors from the body to the world. The rotations from one control point to the next must be shorter than pi.
///   source  Kim, Kim and Shin, "A general construction scheme for unit quaternion curves with simple high order
///           derivatives", 1995; recursions of the rates: Sommer, Usenko, Schubert, Demmel and Cremers, "Efficient
///           derivative computation for cumulative B-splines on Lie groups", 2020, section 4
#pragma once

#include <array>

#include "mtk/types/so3.hpp"
#include "slom/trajectory/blending.hpp"

namespace slom::trajectory {

namespace detail {

/// Returns a x b.
template <class A, class B>
auto cross(const mtk::vect<3, A>& a, const mtk::vect<3, B>& b) {
  using S = mtk::promote_t<A, B>;
  return mtk::vect<3, S>(S(a[1] * b[2] - a[2] * b[1]), S(a[2] * b[0] - a[0] * b[2]),
                         S(a[0] * b[1] - a[1] * b[0]));
}

}  // namespace detail

/// Angular velocity and acceleration, each in the frame of the body [rad/s, rad/s^2].
template <class S>
struct AngularMotion {
  mtk::vect<3, S> velocity, acceleration;
};

/// The N control points of a segment on SO(3), of numbers S. Times may be of another number type than S.
template <int N, class S = double>
class RotationSegment {
 public:
  static constexpr int order = N;
  using Control = mtk::SO3<S>;
  using Controls = std::array<Control, std::size_t{N}>;
  /// This segment over another number type.
  template <class T>
  using Over = RotationSegment<N, T>;

  /// Joins control points and weights.
  RotationSegment(const Blending<N>& blending, const Controls& controls)
      : blending_(blending), first_(controls[0]) {
    for (std::size_t j = 0; j < blending_.steps; ++j) {
      steps_[j] = Control::log(controls[j].inverse() * controls[j + 1]);
    }
  }

  /// Returns the weights of the segment.
  const Blending<N>& blending() const { return blending_; }
  /// Returns R(t).
  template <class Time>
  auto orientationAt(const Time& t) const {
    const auto b = blending_.at(t);
    mtk::SO3<Sum<decltype(b[0])>> R = first_;
    for (std::size_t j = 0; j < blending_.steps; ++j) R = R * turn(b[j], j);
    return R;
  }
  /// Returns the angular velocity in the frame of the body, as a gyroscope reads it: R^-1 dR/dt as a vector.
  template <class Time>
  auto angularVelocityAt(const Time& t) const {
    const auto b = blending_.at(t), rate = blending_.template at<1>(t);
    auto velocity = rate[0] * steps_[0];
    for (std::size_t j = 1; j < blending_.steps; ++j) {
      velocity = turn(b[j], j).inverse() * velocity + rate[j] * steps_[j];
    }
    return velocity;
  }
  /// Returns the derivative by time of angularVelocityAt, in the frame of the body.
  template <class Time>
  auto angularAccelerationAt(const Time& t) const {
    return angularMotionAt(t).acceleration;
  }
  /// Returns angular velocity and acceleration together, in less time than one after the other.
  template <class Time>
  auto angularMotionAt(const Time& t) const {
    const auto b = blending_.at(t), rate = blending_.template at<1>(t),
               curvature = blending_.template at<2>(t);
    AngularMotion<Sum<decltype(b[0])>> motion{rate[0] * steps_[0], curvature[0] * steps_[0]};
    for (std::size_t j = 1; j < blending_.steps; ++j) {
      const auto back = turn(b[j], j).inverse();
      const auto added = rate[j] * steps_[j];
      const auto carried = back * motion.velocity;
      motion.velocity = carried + added;
      motion.acceleration =
          back * motion.acceleration + detail::cross(carried, added) + curvature[j] * steps_[j];
    }
    return motion;
  }
  /// Returns the angular velocity along the axes of the world.
  template <class Time>
  auto worldAngularVelocityAt(const Time& t) const {
    return orientationAt(t) * angularVelocityAt(t);
  }
  /// Returns the angular acceleration along the axes of the world.
  template <class Time>
  auto worldAngularAccelerationAt(const Time& t) const {
    return orientationAt(t) * angularAccelerationAt(t);
  }

 private:
  template <class T>
  using Sum = mtk::promote_t<S, std::remove_cvref_t<T>>;

  /// Returns exp(weight * d_{j+1}).
  template <class T>
  auto turn(const T& weight, std::size_t j) const {
    return mtk::SO3<Sum<T>>::exp(weight * steps_[j]);
  }

  Blending<N> blending_;
  Control first_;
  std::array<mtk::vect<3, S>, std::size_t{N - 1}> steps_;
};

}  // namespace slom::trajectory
