/// MotionPrior: two neighbouring states of a Gaussian process as a measurement.
///
///     const slom::trajectory::MotionPrior<WhiteNoise::on_jerk, mtk::SO3<>> prior(0.1, density);
///     est.insertMeasurement(prior, state_i, state_j, slom::Covariance(prior.covariance()));
///
///   variables  states at two times, VelocityState or AccelerationState of mtk::vect<D> or mtk::SO3<>, or PoseState
///   residual   the later state, seen from the value of the earlier one, minus its prediction without noise:
///              value, velocity and acceleration; of a PoseState those of the position, then those of the orientation
///   noise      processNoise(duration, density)
///   source     Barfoot, Tong, Sarkka 2014, equation 17; on SO(3): Anderson and Barfoot 2015, equations 12 to 16;
///              Tang, Yoon, Barfoot 2019, equation 20
/// GaussianProcess inserts these measurements between all its states.
#pragma once

#include <array>

#include "slom/trajectory/motion_state.hpp"

namespace slom::trajectory {

namespace detail {

/// Returns what noise has added to the motion between two states.
template <class State>
auto added(const State& from, const State& to, double duration) {
  constexpr int D = State::Rate::DOF;
  const auto expected = carried(seenFrom(from.value, from), duration), found = seenFrom(from.value, to);
  mtk::vect<State::parts * D, mtk::scalar_t<State>> sum;
  for (int k = 0; k < State::parts; ++k) {
    for (int d = 0; d < D; ++d) {
      const auto part = static_cast<std::size_t>(k);
      sum[k * D + d] = found[part][d] - expected[part][d];
    }
  }
  return sum;
}

}  // namespace detail

/// The prior of vectors or rotations, V.
template <WhiteNoise W, class V>
class MotionPrior {
 public:
  static constexpr int components = mtk::DOF_v<V>;
  using Density = mtk::vect<components>;

  /// Takes the time between the states [s] and the power spectral density of each component of the tangent space.
  /// Throws [slom.bad-duration] or [slom.bad-density].
  MotionPrior(double duration, const Density& density)
      : duration_(duration), covariance_(processNoise<W>(duration, density)) {}

  /// Returns the covariance of the residual.
  const auto& covariance() const { return covariance_; }
  /// Returns the residual.
  template <class State>
  auto operator()(const State& from, const State& to) const {
    return detail::added(from, to, duration_);
  }

 private:
  static constexpr int kRows = detail::parts_of_state<W> * components;
  double duration_;
  Eigen::Matrix<double, kRows, kRows> covariance_;
};

/// The prior of poses. Density: of the position along the axes of the world, then of the orientation.
template <WhiteNoise W, class S>
class MotionPrior<W, mtk::trafo<mtk::SO3<S>>> {
  static constexpr int kRows = detail::parts_of_state<W> * 3;

 public:
  using Density = mtk::vect<6>;

  /// Takes the time between the states [s] and the power spectral densities. Throws [slom.bad-duration] or
  /// [slom.bad-density].
  MotionPrior(double duration, const Density& density) : duration_(duration) {
    const auto noise = processNoise<W>(duration, density);  // in the order of derivatives
    for (int i = 0; i < 2 * kRows; ++i) {
      for (int j = 0; j < 2 * kRows; ++j) covariance_(i, j) = noise(place(i), place(j));
    }
  }

  /// Returns the covariance of the residual.
  const auto& covariance() const { return covariance_; }
  /// Returns the residual.
  template <class State>
  auto operator()(const State& from, const State& to) const {
    const auto position = detail::added(from.position, to.position, duration_);
    const auto orientation = detail::added(from.orientation, to.orientation, duration_);
    mtk::vect<2 * kRows, mtk::scalar_t<State>> sum;
    for (int i = 0; i < kRows; ++i) sum[i] = position[i], sum[kRows + i] = orientation[i];
    return sum;
  }

 private:
  /// Returns where component i of the residual is among components that are ordered by derivatives.
  static int place(int i) { return 6 * (i % kRows / 3) + 3 * (i / kRows) + i % 3; }

  double duration_;
  Eigen::Matrix<double, 2 * kRows, 2 * kRows> covariance_;
};

}  // namespace slom::trajectory
