/// White noise that drives a motion, and the covariance that it adds in some time.
///   model     d^K x / dt^K = w(t), a white noise with the power spectral density q: E[w(t) w(s)] = q delta(t - s)
///   K = 2     on acceleration: without noise, the velocity is constant      q [unit^2 / s^3]
///   K = 3     on jerk: without noise, the acceleration is constant          q [unit^2 / s^5]
///   state     (x, dx/dt, ..., d^{K-1}x / dt^{K-1})
///   source    Barfoot, Tong, Sarkka, "Batch continuous-time trajectory estimation as exactly sparse Gaussian process
///             regression", 2014, section III; K = 3: Tang, Yoon, Barfoot, "A white-noise-on-jerk motion prior for
///             continuous-time trajectory estimation on SE(3)", 2019, equation 13
#pragma once

#include <Eigen/Core>

#include "mtk/types/vect.hpp"

namespace slom::trajectory {

/// Derivative of the motion that is white noise. Its value is the number of parts of a state.
enum class WhiteNoise {
  on_acceleration = 2,  ///< states of value and velocity
  on_jerk = 3,          ///< states of value, velocity and acceleration
};

namespace detail {

template <WhiteNoise W>
inline constexpr int parts_of_state = static_cast<int>(W);

/// Throws [slom.bad-duration] unless the time between two states is positive and finite.
void checkDuration(double duration);
/// Throws [slom.bad-density] unless all components are positive and finite.
void checkDensity(const double* density, int count);

}  // namespace detail

/// Returns Q(duration): the covariance of a state, given the one `duration` [s] earlier. The state has K parts of D
/// components each, in the order of the derivatives. `density`: power spectral density q of each component. Blocks i, j
/// (from 0) are diag(q) duration^n / (n (K - 1 - i)! (K - 1 - j)!) with n = 2 K - 1 - i - j. Throws [slom.bad-duration]
/// or [slom.bad-density] if a number is not positive and finite.
template <WhiteNoise W, int D>
auto processNoise(double duration, const mtk::vect<D>& density) {
  constexpr int K = detail::parts_of_state<W>;
  detail::checkDuration(duration);
  detail::checkDensity(density.data(), D);
  constexpr double factorials[] = {1, 1, 2};
  Eigen::Matrix<double, K * D, K* D> Q = Eigen::Matrix<double, K * D, K * D>::Zero();
  for (int i = 0; i < K; ++i) {
    for (int j = 0; j < K; ++j) {
      const int n = 2 * K - 1 - i - j;
      double power = 1;
      for (int k = 0; k < n; ++k) power *= duration;
      const double factor = power / (n * factorials[K - 1 - i] * factorials[K - 1 - j]);
      for (int d = 0; d < D; ++d) Q(i * D + d, j * D + d) = factor * density[d];
    }
  }
  return Q;
}

}  // namespace slom::trajectory
