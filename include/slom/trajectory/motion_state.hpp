/// States of a Gaussian process: what its motion is at one time.
///   V         mtk::vect<D> or mtk::SO3<>
///   velocity  of a vector dx/dt; of a rotation the angular velocity in the frame of the body [rad/s]
/// Tangent vectors have the components of the members, one member after another.
#pragma once

#include <array>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "mtk/types/trafo.hpp"
#include "slom/trajectory/rotation_rates.hpp"
#include "slom/trajectory/white_noise.hpp"

namespace slom::trajectory {

/// A value and its velocity: a state of a process with white noise on acceleration.
template <class V>
struct VelocityState {
  using Value = V;
  using Rate = mtk::vect<mtk::DOF_v<V>, mtk::scalar_t<V>>;
  using scalar = mtk::scalar_t<V>;
  static constexpr int parts = 2;
  static constexpr int DOF = parts * mtk::DOF_v<V>;

  V value;
  Rate velocity;

  /// The default value at rest.
  VelocityState() = default;
  /// Sets the value, and the velocity [1/s].
  VelocityState(const V& its_value, const Rate& its_velocity = Rate())  // NOLINT(google-explicit-constructor)
      : value(its_value), velocity(its_velocity) {}

  void boxplus(mtk::vectview<const scalar, DOF> d, scalar scale = scalar(1)) {
    mtk::detail::NamedTraits<VelocityState>::boxplus(*this, d, scale);
  }
  void boxminus(mtk::vectview<scalar, DOF> out, const VelocityState& y) const {
    mtk::detail::NamedTraits<VelocityState>::boxminus(out, *this, y);
  }
  template <class T>
  static auto mtkMembers(T& x) {
    return std::tie(x.value, x.velocity);
  }
  static std::array<std::string_view, 2> mtkMemberNames() { return {"", "velocity"}; }
};

/// A value with velocity and acceleration: a state of a process with white noise on jerk. The acceleration of a
/// rotation is the derivative of its angular velocity, in the frame of the body.
template <class V>
struct AccelerationState {
  using Value = V;
  using Rate = mtk::vect<mtk::DOF_v<V>, mtk::scalar_t<V>>;
  using scalar = mtk::scalar_t<V>;
  static constexpr int parts = 3;
  static constexpr int DOF = parts * mtk::DOF_v<V>;

  V value;
  Rate velocity, acceleration;

  /// The default value at rest.
  AccelerationState() = default;
  /// Sets the value, the velocity [1/s] and the acceleration [1/s^2].
  AccelerationState(const V& its_value,
                    const Rate& its_velocity = Rate(),  // NOLINT(google-explicit-constructor)
                    const Rate& its_acceleration = Rate())
      : value(its_value), velocity(its_velocity), acceleration(its_acceleration) {}

  void boxplus(mtk::vectview<const scalar, DOF> d, scalar scale = scalar(1)) {
    mtk::detail::NamedTraits<AccelerationState>::boxplus(*this, d, scale);
  }
  void boxminus(mtk::vectview<scalar, DOF> out, const AccelerationState& y) const {
    mtk::detail::NamedTraits<AccelerationState>::boxminus(out, *this, y);
  }
  template <class T>
  static auto mtkMembers(T& x) {
    return std::tie(x.value, x.velocity, x.acceleration);
  }
  static std::array<std::string_view, 3> mtkMemberNames() { return {"", "velocity", "acceleration"}; }
};

/// State of a body: the state of its position, along the axes of the world, and the state of its orientation.
template <class Position, class Orientation>
struct PoseState {
  using scalar = mtk::scalar_t<Position>;
  using Pose = mtk::trafo<mtk::SO3<scalar>>;
  static constexpr int DOF = mtk::DOF_v<Position> + mtk::DOF_v<Orientation>;

  Position position;
  Orientation orientation;

  /// The identity at rest.
  PoseState() = default;
  /// Joins the states of position and orientation.
  PoseState(const Position& its_position, const Orientation& its_orientation)
      : position(its_position), orientation(its_orientation) {}
  /// Sets world_T_body, at rest.
  PoseState(const Pose& world_T_body)  // NOLINT(google-explicit-constructor): a start value
      : position(world_T_body.pos), orientation(world_T_body.orient) {}

  /// Returns world_T_body.
  Pose pose() const { return Pose(position.value, orientation.value); }

  void boxplus(mtk::vectview<const scalar, DOF> d, scalar scale = scalar(1)) {
    mtk::detail::NamedTraits<PoseState>::boxplus(*this, d, scale);
  }
  void boxminus(mtk::vectview<scalar, DOF> out, const PoseState& y) const {
    mtk::detail::NamedTraits<PoseState>::boxminus(out, *this, y);
  }
  template <class T>
  static auto mtkMembers(T& x) {
    return std::tie(x.position, x.orientation);
  }
  static std::array<std::string_view, 2> mtkMemberNames() { return {"position", "orientation"}; }
};

namespace detail {

/// The state of V for this noise.
template <class V, WhiteNoise W>
using StateOf = std::conditional_t<W == WhiteNoise::on_jerk, AccelerationState<V>, VelocityState<V>>;

/// The motion seen from a value `base`: x with value = base [+] x, and its derivatives by time.
template <class State>
using LocalMotion = std::array<typename State::Rate, std::size_t{State::parts}>;

template <class V>
inline constexpr bool is_rotation_in_space = false;
template <class S>
inline constexpr bool is_rotation_in_space<mtk::SO3<S>> = true;

/// Returns a state as seen from the value `base`, in the tangent space there.
///   source  Anderson and Barfoot, "Full STEAM ahead: exactly sparse Gaussian process regression for batch
///           continuous-time trajectory estimation on SE(3)", 2015, equations 12 to 14, for right perturbations
template <class State>
LocalMotion<State> seenFrom(const typename State::Value& base, const State& state) {
  LocalMotion<State> local;
  if constexpr (is_rotation_in_space<typename State::Value>) {
    using S = mtk::scalar_t<State>;
    local[0] = State::Value::log(base.inverse() * state.value);
    local[1] = vectorRate<S>(local[0], state.velocity);
    if constexpr (State::parts == 3) {
      local[2] = vectorRate<S>(
          local[0], typename State::Rate(state.acceleration - jacobianRate<S>(local[0], local[1])));
    }
  } else {
    local[0] = state.value - base;
    local[1] = state.velocity;
    if constexpr (State::parts == 3) local[2] = state.acceleration;
  }
  return local;
}

/// Returns the motion after a time [s] without noise: a polynomial.
template <class Rate, std::size_t K>
std::array<Rate, K> carried(const std::array<Rate, K>& motion, double duration) {
  std::array<Rate, K> later = motion;
  for (std::size_t i = 0; i < K; ++i) {
    double factor = 1;
    for (std::size_t j = i + 1; j < K; ++j) {
      factor *= duration / static_cast<double>(j - i);
      later[i] = later[i] + factor * motion[j];
    }
  }
  return later;
}

/// Returns the state with this motion as seen from the value `base`: the inverse of seenFrom.
template <class V, class Rate, std::size_t K>
auto stateAt(const V& base, const std::array<Rate, K>& local) {
  std::conditional_t<K == 3, AccelerationState<V>, VelocityState<V>> state(mtk::moved(base, local[0]));
  if constexpr (is_rotation_in_space<V>) {
    state.velocity = angularVelocity(local[0], local[1]);
    if constexpr (K == 3)
      state.acceleration = angularVelocity(local[0], local[2]) + jacobianRate(local[0], local[1]);
  } else {
    state.velocity = local[1];
    if constexpr (K == 3) state.acceleration = local[2];
  }
  return state;
}

/// Returns the state after a time [s] without noise.
template <class State>
State predicted(const State& state, double duration) {
  return stateAt(state.value, carried(seenFrom(state.value, state), duration));
}
template <class Position, class Orientation>
PoseState<Position, Orientation> predicted(const PoseState<Position, Orientation>& state, double duration) {
  return {predicted(state.position, duration), predicted(state.orientation, duration)};
}

}  // namespace detail
}  // namespace slom::trajectory
