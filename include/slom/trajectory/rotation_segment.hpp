/// RotationSegment: one segment of a cumulative B-spline on SO(3).
///   R(t) = C_0 exp(b_1(t) d_1) ... exp(b_{N-1}(t) d_{N-1})    with d_j = log(C_{j-1}^-1 C_j)
/// R moves vectors from the body to the world. The rotations from one control point to the next must be shorter than
/// pi.
///   source  Kim, Kim and Shin, "A general construction scheme for unit quaternion curves with simple high order
///           derivatives", 1995
/// If control points or the time carry derivatives, all is computed over plain numbers (rotation_recursion.hpp) and
/// multiplied by these derivatives once, at the end.
#pragma once

#include <array>
#include <type_traits>

#include "mtk/types/trafo.hpp"
#include "slom/trajectory/rotation_recursion.hpp"

namespace slom::trajectory {

/// Angular velocity and acceleration, each in the frame of the body [rad/s, rad/s^2].
template <class S>
struct AngularMotion {
  mtk::vect<3, S> velocity, acceleration;
};

/// The N control points of a segment on SO(3), of numbers S. Times may be of another number type than S.
template <int N, class S = double>
class RotationSegment {
  template <class X>
  struct Plain {
    using type = X;
  };
  template <class X, std::uint64_t C>
  struct Plain<mtk::SparseDual<X, C>> {
    using type = X;
  };
  using V = typename Plain<S>::type;  // without derivatives

 public:
  static constexpr int order = N;
  using Control = mtk::SO3<S>;
  using Controls = std::array<Control, std::size_t{N}>;
  /// This segment over another number type.
  template <class T>
  using Over = RotationSegment<N, T>;

  /// Joins control points and weights.
  RotationSegment(const Blending<N>& blending, const Controls& controls)
      : blending_(blending), controls_(controls), recursion_(valuesOf(controls)) {}

  /// Returns the weights of the segment.
  const Blending<N>& blending() const { return blending_; }
  /// Returns R(t).
  template <class Time>
  auto orientationAt(const Time& time) const {
    const auto t = timeOf(time);
    using D = Sum<decltype(t)>;
    if constexpr (std::is_same_v<D, V>) {
      return Control(controls_[0] * recursion_.turn(blending_.at(t)));
    } else {
      const auto turn = recursion_.turnWithDerivatives(blending_.at(valueOf(t)));
      const auto velocity = velocityForTime(t);
      const auto first = turn.turn.inverse().toRotationMatrix();
      return mtk::SO3<D>(valuesOf(controls_)[0] * turn.turn,
                         derivatives<D>(turn.by_step, &first, velocity, t));
    }
  }
  /// Returns the angular velocity in the frame of the body, as a gyroscope reads it: R^-1 dR/dt as a vector.
  template <class Time>
  auto angularVelocityAt(const Time& time) const {
    const auto t = timeOf(time);
    using D = Sum<decltype(t)>;
    if constexpr (std::is_same_v<D, V>) {
      return recursion_.template rates<1, 0>(blending_, t).velocity;
    } else {
      const auto rates = recursion_.template rates < 2, is_dual_segment ? 1 : 0 > (blending_, valueOf(t));
      return vectorOf<D>(rates.velocity, rates.velocity_by_step, rates.acceleration, t);
    }
  }
  /// Returns the derivative by time of angularVelocityAt, in the frame of the body.
  template <class Time>
  auto angularAccelerationAt(const Time& time) const {
    return angularMotionAt(time).acceleration;
  }
  /// Returns angular velocity and acceleration together, in less time than one after the other.
  template <class Time>
  auto angularMotionAt(const Time& time) const {
    const auto t = timeOf(time);
    using D = Sum<decltype(t)>;
    if constexpr (std::is_same_v<D, V>) {
      const auto rates = recursion_.template rates<2, 0>(blending_, t);
      return AngularMotion<D>{rates.velocity, rates.acceleration};
    } else {
      const auto rates = recursion_.template rates < 3, is_dual_segment ? 2 : 0 > (blending_, valueOf(t));
      return AngularMotion<D>{vectorOf<D>(rates.velocity, rates.velocity_by_step, rates.acceleration, t),
                              vectorOf<D>(rates.acceleration, rates.acceleration_by_step, rates.jerk, t)};
    }
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
  static constexpr bool is_dual_segment = mtk::detail::is_dual<S>;
  using Values = std::array<mtk::SO3<V>, std::size_t{N}>;
  using Vector = mtk::vect<3, V>;
  template <class T>
  using Sum = mtk::promote_t<S, std::remove_cvref_t<T>>;

  static Values valuesOf(const Controls& controls) {
    if constexpr (is_dual_segment) {
      Values values;
      for (std::size_t j = 0; j < values.size(); ++j) values[j] = controls[j].value();
      return values;
    } else {
      return controls;
    }
  }
  /// Returns a time as a V or as a dual number over V.
  template <class Time>
  static auto timeOf(const Time& t) {
    const auto number = t + 0.0;
    if constexpr (mtk::detail::is_dual<std::remove_cvref_t<decltype(number)>>) {
      return number;
    } else {
      return V(number);
    }
  }
  template <class T>
  static V valueOf(const T& t) {
    if constexpr (mtk::detail::is_dual<T>) {
      return t.value();
    } else {
      return t;
    }
  }
  /// Returns the angular velocity if the time carries derivatives, else 0.
  template <class T>
  Vector velocityForTime(const T& t) const {
    if constexpr (mtk::detail::is_dual<T>) {
      return recursion_.template rates<1, 0>(blending_, t.value()).velocity;
    } else {
      return Vector();
    }
  }

  /// Returns the derivatives of something by the unknowns of D, from those by the steps, by the first control point
  /// besides (null: none) and by time.
  template <class D, class T>
  auto derivatives(const detail::StepMatrices<N, V>& by_step, const detail::Matrix3<V>* by_first,
                   const Vector& by_time, const T& t) const {
    mtk::detail::RowPartials<V, D::columns> rows;
    rows.fill(mtk::detail::Partials<V, D::columns>::zero());
    if constexpr (is_dual_segment) {
      for (std::size_t k = 0; k < std::size_t{N}; ++k) {
        detail::Matrix3<V> M = recursion_.byControl(by_step, k);
        if (k == 0 && by_first != nullptr) M += *by_first;
        rows = mtk::detail::add<D::columns, S::columns, V>(
            rows, mtk::detail::multiply<V>(M, controls_[k].partials()));
      }
    }
    if constexpr (mtk::detail::is_dual<T>) {
      std::array<typename T::Partials, 3> moved;
      for (int i = 0; i < 3; ++i) {
        moved[static_cast<std::size_t>(i)] =
            mtk::detail::apply(t.partials(), [&](const auto& d) { return by_time[i] * d; });
      }
      rows = mtk::detail::add<D::columns, T::columns, V>(rows, moved);
    }
    return rows;
  }
  /// Returns a vector of D with this value and derivatives.
  template <class D, class T>
  mtk::vect<3, D> vectorOf(const Vector& value, const detail::StepMatrices<N, V>& by_step,
                           const Vector& by_time, const T& t) const {
    const auto rows = derivatives<D>(by_step, nullptr, by_time, t);
    return mtk::vect<3, D>(D(value[0], rows[0]), D(value[1], rows[1]), D(value[2], rows[2]));
  }

  Blending<N> blending_;
  Controls controls_;
  detail::RotationRecursion<N, V> recursion_;
};

namespace detail {

/// Returns the orientations of poses.
template <class S, std::size_t N>
std::array<mtk::SO3<S>, N> orientationsOf(const std::array<mtk::trafo<mtk::SO3<S>>, N>& poses) {
  std::array<mtk::SO3<S>, N> result;
  for (std::size_t j = 0; j < N; ++j) result[j] = poses[j].orient;
  return result;
}

}  // namespace detail
}  // namespace slom::trajectory
