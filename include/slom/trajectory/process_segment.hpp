/// Segments of a Gaussian process: its mean between two neighbouring states, given both.
///   R^D        x(t) = x_0 + xi(t)
///   SO(3)      R(t) = R_0 exp(xi(t))
///   xi         Lambda(t) (0, xi_0', ...) + Psi(t) (xi_1, xi_1', ...): the polynomial of degree 2 K - 1 with the value
///              and the first K - 1 derivatives of both states, in the tangent space at the first one
/// With white noise, the power spectral density cancels in Lambda and Psi. Rotations from one state to the next must be
/// shorter than pi. Beyond the two states, the polynomial continues.
///   source     Barfoot, Tong, Sarkka 2014, equation 11; Anderson and Barfoot 2015, section IV.C. There the polynomial is
///              in SE(3); here position and orientation have one each, as in PoseSegment.
#pragma once

#include <array>

#include "slom/trajectory/motion_prior.hpp"
#include "slom/trajectory/pose_segment.hpp"

namespace slom::trajectory {

namespace detail {

/// The weights of the value and the first K - 1 derivatives at u = 0, then those at u = 1 (Hermite interpolation).
template <int K>
inline constexpr std::array<std::array<double, std::size_t{2 * K}>, std::size_t{2 * K}> hermite_weights{};
template <>
inline constexpr std::array<std::array<double, 4>, 4> hermite_weights<2>{
    {{1, 0, -3, 2}, {0, 1, -2, 1}, {0, 0, 3, -2}, {0, 0, -1, 1}}};
template <>
inline constexpr std::array<std::array<double, 6>, 6> hermite_weights<3>{{{1, 0, 0, -10, 15, -6},
                                                                          {0, 1, 0, -6, 8, -3},
                                                                          {0, 0, 0.5, -1.5, 1.5, -0.5},
                                                                          {0, 0, 0, 10, -15, 6},
                                                                          {0, 0, 0, -4, 7, -3},
                                                                          {0, 0, 0, 0.5, -1, 0.5}}};

/// The curve xi(t) between two states.
template <class State>
class LocalCurve {
 public:
  LocalCurve(const Blending<2>& span, const std::array<State, 2>& states)
      : start_(span.start()),
        spacing_(span.spacing()),
        base_(states[0].value),
        from_(seenFrom(base_, states[0])),
        to_(seenFrom(base_, states[1])) {}

  /// Returns the value of the first state.
  const typename State::Value& base() const { return base_; }
  /// Returns xi(t), or its derivative of order `Derivative` by time.
  template <int Derivative, class Time>
  auto at(const Time& t) const {
    constexpr auto& weights = hermite_weights<State::parts>;
    constexpr auto parts = std::size_t{State::parts};
    const auto since = t - start_;
    auto sum = derivativeOf<Derivative>(weights[parts], since, spacing_) * to_[0];  // xi_0 is 0
    double unit = 1;
    for (std::size_t j = 1; j < parts; ++j) {
      unit *= spacing_;
      sum = sum + (unit * derivativeOf<Derivative>(weights[j], since, spacing_)) * from_[j] +
            (unit * derivativeOf<Derivative>(weights[parts + j], since, spacing_)) * to_[j];
    }
    return mtk::vect<State::Rate::DOF, std::remove_cvref_t<decltype(sum[0])>>(sum);
  }

 private:
  double start_, spacing_;
  typename State::Value base_;
  LocalMotion<State> from_, to_;
};

template <class State>
inline constexpr bool has_acceleration = State::parts == 3;

}  // namespace detail

/// The process in R^D between two states of numbers S. Times may be of another number type than S.
template <int D, WhiteNoise W, class S = double>
class VectorProcessSegment {
 public:
  static constexpr int order = 2;
  using Control = detail::StateOf<mtk::vect<D, S>, W>;
  using Controls = std::array<Control, 2>;
  /// The measurement between two states.
  using Prior = MotionPrior<W, mtk::vect<D>>;
  /// This segment over another number type.
  template <class T>
  using Over = VectorProcessSegment<D, W, T>;

  /// Joins two states, at the start and the end of the span.
  VectorProcessSegment(const Blending<2>& span, const Controls& states) : curve_(span, states) {}

  /// Returns x(t).
  template <class Time>
  auto at(const Time& t) const {
    return curve_.base() + curve_.template at<0>(t);
  }
  /// Returns dx/dt.
  template <class Time>
  auto velocityAt(const Time& t) const {
    return curve_.template at<1>(t);
  }
  /// Returns d2x/dt2.
  template <class Time>
  auto accelerationAt(const Time& t) const {
    static_assert(detail::has_acceleration<Control>,
                  "slom: the acceleration of this process is white noise and has no value; use "
                  "WhiteNoise::on_jerk");
    return curve_.template at<2>(t);
  }

 private:
  detail::LocalCurve<Control> curve_;
};

/// The process of an orientation between two states of numbers S. R moves vectors from the body to the world.
template <WhiteNoise W, class S = double>
class RotationProcessSegment {
 public:
  static constexpr int order = 2;
  using Control = detail::StateOf<mtk::SO3<S>, W>;
  using Controls = std::array<Control, 2>;
  /// The measurement between two states.
  using Prior = MotionPrior<W, mtk::SO3<>>;
  /// This segment over another number type.
  template <class T>
  using Over = RotationProcessSegment<W, T>;

  /// Joins two states, at the start and the end of the span.
  RotationProcessSegment(const Blending<2>& span, const Controls& states) : curve_(span, states) {}

  /// Returns R(t).
  template <class Time>
  auto orientationAt(const Time& t) const {
    const auto xi = curve_.template at<0>(t);
    return curve_.base() * mtk::SO3<std::remove_cvref_t<decltype(xi[0])>>::exp(xi);
  }
  /// Returns the angular velocity in the frame of the body, as a gyroscope reads it.
  template <class Time>
  auto angularVelocityAt(const Time& t) const {
    return detail::angularVelocity(curve_.template at<0>(t), curve_.template at<1>(t));
  }
  /// Returns the derivative by time of angularVelocityAt, in the frame of the body.
  template <class Time>
  auto angularAccelerationAt(const Time& t) const {
    static_assert(detail::has_acceleration<Control>,
                  "slom: the acceleration of this process is white noise and has no value; use "
                  "WhiteNoise::on_jerk");
    const auto xi = curve_.template at<0>(t);
    return detail::angularVelocity(xi, curve_.template at<2>(t)) +
           detail::jacobianRate(xi, curve_.template at<1>(t));
  }
  /// Returns angular velocity and acceleration together.
  template <class Time>
  auto angularMotionAt(const Time& t) const {
    const auto velocity = angularVelocityAt(t);
    return AngularMotion<std::remove_cvref_t<decltype(velocity[0])>>{velocity, angularAccelerationAt(t)};
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
  detail::LocalCurve<Control> curve_;
};

/// The process of a body between two states of numbers S: one of its position in the world and one of its orientation.
/// It has the functions of PoseSegment; those of accelerations need WhiteNoise::on_jerk.
template <WhiteNoise W, class S = double>
class PoseProcessSegment : public PoseFunctions<VectorProcessSegment<3, W, S>, RotationProcessSegment<W, S>> {
  using Position = VectorProcessSegment<3, W, S>;
  using Rotation = RotationProcessSegment<W, S>;

 public:
  static constexpr int order = 2;
  using Control = PoseState<typename Position::Control, typename Rotation::Control>;
  using Controls = std::array<Control, 2>;
  /// The measurement between two states.
  using Prior = MotionPrior<W, mtk::trafo<mtk::SO3<>>>;
  /// This segment over another number type.
  template <class T>
  using Over = PoseProcessSegment<W, T>;

  /// Joins two states, at the start and the end of the span.
  PoseProcessSegment(const Blending<2>& span, const Controls& states)
      : PoseFunctions<Position, Rotation>(Position(span, {states[0].position, states[1].position}),
                                          Rotation(span, {states[0].orientation, states[1].orientation})) {}
};

}  // namespace slom::trajectory
