/// Strap-down inertial navigation with biases: 15 degrees of freedom.
///
///     slom::filter::StrapdownState<> start;                               // pose, velocity, biases
///     slom::ErrorStateFilter filter(start, slom::StandardDeviation(sigmas));
///     filter.predict(slom::filter::Strapdown(), slom::filter::strapdownNoise(imu, dt), gyro, force, dt);
///     filter.update(slom::filter::GnssPosition(), gps, lever, slom::StandardDeviation(0.5));
///
///   world   fixed, z up; the rotation of the earth is not modelled (0.004 degrees per second)
///   body    the axes and the place of the IMU; at rest the accelerometer reads +g upwards
///   error   (pos, orient, velocity, gyro_bias, force_bias): position in the world, rotation in the body
///   source  Groves, "Principles of GNSS, inertial, and multisensor integrated navigation systems", 2nd edition, 2013,
///           section 5.4; noise Farrell, "Aided navigation", 2008, section 4.7
#pragma once

#include "mtk/types/trafo.hpp"
#include "slom/filter/options.hpp"
#include "slom/filter/square_root.hpp"
#include "slom/model/imu_noise.hpp"
#include "slom/model/noise.hpp"

namespace slom::filter {

/// The state: 15 degrees of freedom.
template <class S = double>
struct StrapdownState {
  mtk::trafo<mtk::SO3<S>> pose;  ///< world_T_body [m]
  mtk::vect<3, S> velocity;      ///< in the world [m/s]
  mtk::vect<3, S> gyro_bias;     ///< [rad/s]
  mtk::vect<3, S> force_bias;    ///< [m/s^2]
};

/// The motion with constant readings of angular velocity [rad/s] and specific force [m/s^2] for dt [s].
struct Strapdown {
  double gravity = 9.81;  ///< [m/s^2]

  template <class State, class T>
  State operator()(const State& x, const mtk::vect<3, T>& gyro, const mtk::vect<3, T>& force,
                   const T& dt) const {
    using S = mtk::scalar_t<State>;
    const mtk::SO3<S> half_turn = mtk::SO3<S>::exp(mtk::vect<3, S>((gyro - x.gyro_bias) * (dt / T(2))));
    const mtk::SO3<S> middle = x.pose.orient * half_turn;
    const mtk::vect<3, S> gained(
        (middle * mtk::vect<3, S>(force - x.force_bias) - mtk::vect<3, S>(S(0), S(0), S(T(gravity)))) * dt);
    State y = x;
    y.pose.pos = x.pose.pos + x.velocity * dt + gained * (dt / T(2));
    y.pose.orient = middle * half_turn;
    y.velocity = x.velocity + gained;
    return y;
  }
};

/// Returns the covariance that an IMU's white noise and bias walks add in dt [s]. Within the step, the noise of the
/// accelerometer is also integrated to the position. So the covariance is right for any part of a duration, as
/// slom::FilterHistory needs.
template <class S>
auto strapdownNoise(const ImuNoise& imu, const S& dt) {
  return grownCovariance(dt, [&](const S& h) {
    const auto square = [](double x) { return S(x * x); };
    detail::SquareMatrix<S, 15> Q = detail::SquareMatrix<S, 15>::Zero();
    const S q = square(imu.force);
    for (int i = 0; i < 3; ++i) {
      Q(i, i) = q * h * h * h / S(3);
      Q(i, 6 + i) = Q(6 + i, i) = q * h * h / S(2);
      Q(3 + i, 3 + i) = square(imu.gyro) * h;
      Q(6 + i, 6 + i) = q * h;
      Q(9 + i, 9 + i) = square(imu.gyro_walk) * h;
      Q(12 + i, 12 + i) = square(imu.force_walk) * h;
    }
    return Q;
  });
}

/// Residual of a position in the world [m]: the position of a point at `lever` [m] in the body, minus the reading.
struct GnssPosition {
  template <class State, class T>
  auto operator()(const State& x, const mtk::vect<3, T>& position, const mtk::vect<3, T>& lever) const {
    using V = mtk::vect<3, mtk::scalar_t<State>>;
    return V(x.pose * V(lever) - position);
  }
};

/// Residual of a velocity in the world [m/s] of a point at `lever` [m] in the body, which turns with gyro [rad/s].
struct GnssVelocity {
  template <class State, class T>
  auto operator()(const State& x, const mtk::vect<3, T>& velocity, const mtk::vect<3, T>& lever,
                  const mtk::vect<3, T>& gyro) const {
    using V = mtk::vect<3, mtk::scalar_t<State>>;
    const V w(gyro - x.gyro_bias);
    const V along(w[1] * lever[2] - w[2] * lever[1], w[2] * lever[0] - w[0] * lever[2],
                  w[0] * lever[1] - w[1] * lever[0]);
    return V(x.velocity + x.pose.orient * along - velocity);
  }
};

/// Residual of standing still (a foot on the ground, a parked vehicle): the velocity [m/s].
struct ZeroVelocity {
  template <class State>
  auto operator()(const State& x) const {
    return x.velocity;
  }
};

/// Residual of a vehicle that neither slips sideways nor jumps: the velocity along y and z of the body [m/s].
struct NoSideslip {
  template <class State>
  auto operator()(const State& x) const {
    using S = mtk::scalar_t<State>;
    const mtk::vect<3, S> in_body(x.pose.orient.inverse() * x.velocity);
    return mtk::vect<2, S>(in_body[1], in_body[2]);
  }
};

}  // namespace slom::filter
