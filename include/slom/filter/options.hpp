/// What the steps of a filter take besides functions, data and noise.
#pragma once

#include <cmath>
#include <type_traits>

#include "mtk/error.hpp"
#include "slom/model/loss.hpp"
#include "slom/model/noise.hpp"

namespace slom {

/// Noise that enters a motion as an argument behind the state: motion(x, w, ...) with w ~ N(0, Q), a vector of Size
/// numbers. Use it for the noise of an input, such as a gyroscope. Made by slom::noiseArgument.
template <int Size, class N>
struct NoiseArgument {
  N noise;
};

/// Returns noise that enters the motion as an argument behind the state, a vector of Size numbers. In a motion with a `const
/// auto&` parameter for it, an index beyond the end reads NaN, so that the prediction is refused:
///     filter.predict(motion, slom::noiseArgument<6>(slom::StandardDeviation(sigmas)), gyro, force, dt);
template <int Size, class N>
NoiseArgument<Size, N> noiseArgument(const N& noise) {
  return {noise};
}

/// The duration h of a prediction [s], at any place among its data. The motion gets it as a number:
///     filter.predict(motion, slom::SpectralDensity(q), imu, slom::Duration(dt));
/// A prediction with slom::SpectralDensity needs it. Other predictions take their last number as the duration, unless one is
/// marked.
template <class T = double>
struct Duration {
  T seconds;
  /// Sets the duration. A prediction refuses numbers that are not positive and finite.
  explicit constexpr Duration(const T& h) : seconds(h) {}
};
template <class T>
Duration(const T&) -> Duration<std::conditional_t<std::is_floating_point_v<T>, T, double>>;

/// White noise in continuous time, by its power spectral density: a number (for each component) or a vector. The
/// prediction needs slom::Duration(h).
///   additive        density of the rate of each component, in squared units of the component per second. Its covariance
///                   is the integral over [0, h] of Phi(s) diag(density) Phi(s)^T, where Phi(s) is the derivative of the
///                   motion that takes s, by Gauss-Legendre quadrature with 3 points: exact for polynomials in s up to
///                   degree 5, as in constant velocity (s^2) and constant acceleration (s^4)
///   noiseArgument   density of an input that is constant during h: covariance density / h
///   source          Maybeck, "Stochastic models, estimation, and control", 1979, equation 4-127
template <class T = double>
struct SpectralDensity {
  T value;
  /// Sets the density, in squared units per second.
  template <class X>
  explicit SpectralDensity(const X& x) : value(detail::plainNoise(x)) {}
};
template <class X>
SpectralDensity(const X&) -> SpectralDensity<detail::PlainNoise<X>>;

/// The covariance that a prediction of `duration` adds, as a function of the duration: slom::grownCovariance(dt, q)
/// calls q(dt). Use it in place of slom::Covariance, and in predictions of a slom::FilterHistory, which divides
/// durations:
///     f.predict(motion, slom::grownCovariance(dt, [](double h) { return mtk::vect<2>(0, 0.5 * h); }), dt);
template <class T = double>
struct GrownCovariance : Noise<NoiseForm::covariance, T> {};

/// Returns the covariance of a duration [s]: a number, a vector or a matrix that covariance(duration) returns.
template <class S, class F>
auto grownCovariance(const S& duration, const F& covariance) {
  using T = detail::PlainNoise<decltype(covariance(duration))>;
  return GrownCovariance<T>{{detail::plainNoise(covariance(duration))}};
}

/// Rejects measurements with an improbable innovation: if the model holds, the gate passes a measurement with this
/// probability. The test is that of the normalised innovation squared (NIS) against chi-square.
///   source  Bar-Shalom, Li, Kirubarajan, "Estimation with applications to tracking and navigation", 2001, section 3.7
struct Gate {
  double probability;
  /// Sets the probability, in (0, 1), such as 0.999. Throws [slom.bad-option] for other numbers.
  explicit constexpr Gate(double pass_probability) : probability(pass_probability) {
    if (!(probability > 0 && probability < 1)) {
      mtk::detail::raise(mtk::Error(
          "slom.bad-option",
          "gate: the probability of passing is not between 0 and 1; pass a number such as 0.999", "gate"));
    }
  }
};

/// Iterates an update: the function is linearised again at the new state, up to `most` times. The result is the
/// Gauss-Newton estimate of state given prior and measurement. Steps that raise the cost are halved, and the result says
/// whether the iteration converged.
///   source  Bell and Cathey, "The iterated Kalman filter update as a Gauss-Newton method", 1993; on manifolds He, Xu, Zhang,
///           "Kalman filters on differentiable manifolds", 2021, section IV
struct Iterations {
  int most;
  /// Sets the limit, 1 or more. Throws [slom.bad-option] for other numbers.
  explicit constexpr Iterations(int most_iterations) : most(most_iterations) {
    if (most < 1) {
      mtk::detail::raise(mtk::Error("slom.bad-option",
                                    "iterations: an update needs at least 1; pass a number such as 10",
                                    "iterations"));
    }
  }
};

namespace detail {

/// False for vectors and matrices, which Eigen lets be called with anything.
template <class F>
inline constexpr bool is_function = !requires { typename F::PlainObject; };

template <class A>
inline constexpr bool is_noise_argument = false;
template <int Size, class N>
inline constexpr bool is_noise_argument<NoiseArgument<Size, N>> = true;
template <class A>
inline constexpr bool is_density = false;
template <class T>
inline constexpr bool is_density<SpectralDensity<T>> = true;
template <int Size, class T>
inline constexpr bool is_density<NoiseArgument<Size, SpectralDensity<T>>> = true;
/// True for noise that grows with the duration of a prediction, so that the prediction can be divided.
template <class A>
inline constexpr bool grows_with_duration = is_density<A>;
template <class T>
inline constexpr bool grows_with_duration<GrownCovariance<T>> = true;
template <class A>
inline constexpr bool is_duration = false;
template <class T>
inline constexpr bool is_duration<Duration<T>> = true;
template <class A>
inline constexpr bool is_motion_noise =
    is_noise_argument<A> || is_density<A> || (IsNoise<A> && !std::is_same_v<A, UnitCovariance>);

/// Returns the probability that chi-square with `dof` degrees of freedom exceeds x. The library's chiSquareProbability takes
/// any real number of degrees, by series that need compiled code.
///   source  NIST Digital Library of Mathematical Functions, 8.4.10 and 8.4.15, for halves of integers
inline double chiSquareTail(double x, int dof) {
  if (!(x > 0)) return 1;
  const double y = x / 2;
  double term =
      dof % 2 == 0 ? std::exp(-y) : std::exp(-y) * std::sqrt(y) * 2 / std::sqrt(3.14159265358979323846);
  double sum = dof % 2 == 0 ? 0 : std::erfc(std::sqrt(y));
  for (double a = dof % 2 == 0 ? 1 : 1.5; 2 * a <= dof + 0.5; a += 1) {
    sum += term;
    term *= y / a;
  }
  return sum;
}

/// Settings of one update.
struct UpdateSettings {
  double gate = 1;  ///< probability of passing
  int iterations = 0;
  Loss loss;

  void take(const Gate& g) { gate = g.probability; }
  void take(const Iterations& i) { iterations = i.most; }
  void take(const Loss& l) { loss = l; }

  /// Returns whether the gate passes a residual of this length with this NIS.
  bool passes(double nis, int dof) const { return gate >= 1 || chiSquareTail(nis, dof) >= 1 - gate; }
  int mostIterations() const { return iterations > 0 ? iterations : loss.kind() != nullptr ? 10 : 1; }
  /// Returns the weight that the loss gives to a residual of this squared length in units of R; 1 without a loss.
  template <class S>
  S weightOf(const S& square) const {
    if (loss.kind() == nullptr) return S(1);
    return S(loss.evaluate(double(square)).first);
  }
  /// Returns the cost of such a residual: its squared length without a loss.
  template <class S>
  S costOf(const S& square) const {
    return loss.kind() == nullptr ? square : S(loss.evaluate(double(square)).rho);
  }
};
/// Returns the factor of R for a weight.
template <class S>
S factorOf(const S& weight) {
  const S least = S(1e-12);
  return S(1) / (weight > least ? weight : least);
}
template <class A>
inline constexpr bool is_update_option =
    std::is_same_v<A, Gate> || std::is_same_v<A, Iterations> || IsLoss<A>;

}  // namespace detail

}  // namespace slom
