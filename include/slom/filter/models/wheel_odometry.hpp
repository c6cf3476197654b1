/// A wheeled robot in the plane with a yaw gyroscope: 4 degrees of freedom.
///
///     slom::ErrorStateFilter filter(slom::filter::WheelState<>{}, slom::StandardDeviation(sigmas));
///     filter.predict(slom::filter::WheelOdometry(), slom::filter::wheelNoise(noise, velocity, rate, dt), velocity, rate, dt);
///     filter.update(slom::filter::PlanePosition(), gps, lever, slom::StandardDeviation(0.5));
///
///   error   (pos, orient, gyro_bias): position in the world [m], heading [rad], bias [rad/s]
///   source  Thrun, Burgard, Fox, "Probabilistic robotics", 2005, section 5.3
#pragma once

#include "mtk/types/trafo.hpp"
#include "slom/filter/options.hpp"

namespace slom::filter {

/// The state: 4 degrees of freedom.
template <class S = double>
struct WheelState {
  mtk::trafo<mtk::SO2<S>> pose;  ///< world_T_robot, x forward
  mtk::vect<1, S> gyro_bias;     ///< [rad/s]
};

/// The motion with a constant velocity in the robot's frame [m/s] and yaw rate [rad/s] for dt [s].
struct WheelOdometry {
  template <class State, class T>
  State operator()(const State& x, const mtk::vect<2, T>& velocity, const T& rate, const T& dt) const {
    using S = mtk::scalar_t<State>;
    const mtk::SO2<S> half_turn(S((rate - x.gyro_bias[0]) * (dt / T(2))));
    const mtk::SO2<S> middle = x.pose.orient * half_turn;
    State y = x;
    y.pose.pos = x.pose.pos + middle * mtk::vect<2, S>(velocity * dt);
    y.pose.orient = middle * half_turn;
    return y;
  }
};

/// Noise of the odometry.
template <class S = double>
struct WheelNoise {
  S slip = S(0.05);       ///< error of the distance, per square root of the distance [m/sqrt(m)]
  S gyro = S(2e-3);       ///< white noise [rad/s/sqrt(Hz)]
  S gyro_walk = S(1e-4);  ///< of the bias [rad/s/sqrt(s)]
  S turn = S(0.02);       ///< error of the turn, per square root of the turn [rad/sqrt(rad)]
};

/// Returns the covariance that the odometry adds in dt [s], which is right for any part of a duration.
template <class S>
auto wheelNoise(const WheelNoise<S>& noise, const mtk::vect<2, S>& velocity, const S& rate, const S& dt) {
  return grownCovariance(dt, [&](const S& h) {
    mtk::vect<4, S> variances;
    variances[0] = variances[1] = noise.slip * noise.slip * velocity.norm() * h;
    variances[2] = noise.gyro * noise.gyro * h + noise.turn * noise.turn * (rate < S(0) ? -rate : rate) * h;
    variances[3] = noise.gyro_walk * noise.gyro_walk * h;
    return variances;
  });
}

/// Residual of a position in the world [m]: the position of a point at `lever` [m] in the robot, minus the reading.
struct PlanePosition {
  template <class State, class T>
  auto operator()(const State& x, const mtk::vect<2, T>& position, const mtk::vect<2, T>& lever) const {
    using V = mtk::vect<2, mtk::scalar_t<State>>;
    return V(x.pose * V(lever) - position);
  }
};

}  // namespace slom::filter
