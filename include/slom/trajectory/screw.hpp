/// The exponential and the logarithm of SE(3), for splines. Variables are not perturbed by it (docs/conventions.md).
///   twist      (linear v, angular w), in the frame of the body
///   exp        rotation exp(w), position V v with V = I + b [w]x + c [w]x^2, b = (1 - cos a) / a^2,
///              c = (a - sin a) / a^3, a = |w|
///   log        v = V^-1 p, V^-1 = I - [w]x / 2 + e [w]x^2, e = (1 - b / (2 s)) / a^2, s = sin a / a
///   source     Sola, Deray, Atchuthan, "A micro Lie theory for state estimation in robotics", 2018, appendix D
#pragma once

#include <array>
#include <cmath>

#include "mtk/types/trafo.hpp"
#include "slom/trajectory/rotation_recursion.hpp"

namespace slom::trajectory {

/// Linear and angular velocity of a body, in the frame of the body; also its derivative by time.
template <class S>
struct Twist {
  mtk::vect<3, S> linear, angular;

  /// Returns the twist times a number.
  template <class T>
  auto times(const T& factor) const {
    return Twist<mtk::promote_t<S, T>>{factor * linear, factor * angular};
  }
  /// Returns the sum of two twists.
  template <class T>
  auto plus(const Twist<T>& b) const {
    return Twist<mtk::promote_t<S, T>>{linear + b.linear, angular + b.angular};
  }
};

namespace detail {

/// Squared angle up to which series are used. Their last terms are then below the rounding error of a double.
inline constexpr double kScrewSeries = 0.25;

/// Returns the polynomial with these coefficients, the constant one first.
template <class S, std::size_t N>
S polynomialAt(const std::array<long double, N>& coefficients, const S& x) {
  using Number = mtk::detail::built_in_t<S>;
  S sum(static_cast<Number>(coefficients[N - 1]));
  for (std::size_t k = N - 1; k > 0; --k) sum = sum * x + S(static_cast<Number>(coefficients[k - 1]));
  return sum;
}

/// Returns b and c of V for a squared angle.
template <class S>
std::array<S, 2> screwFactors(const S& square) {
  return mtk::detail::branch(
      square < S(kScrewSeries),
      [&] {
        static constexpr std::array<long double, 8> b{
            1.0L / 2,       -1.0L / 24,        1.0L / 720,         -1.0L / 40320,
            1.0L / 3628800, -1.0L / 479001600, 1.0L / 87178291200, -1.0L / 20922789888000};
        static constexpr std::array<long double, 8> c{
            1.0L / 6,        -1.0L / 120,        1.0L / 5040,          -1.0L / 362880,
            1.0L / 39916800, -1.0L / 6227020800, 1.0L / 1307674368000, -1.0L / 355687428096000};
        return std::array<S, 2>{polynomialAt(b, square), polynomialAt(c, square)};
      },
      [&] {
        using std::sqrt;
        const S angle = sqrt(square);
        const auto [sine, cosine] = mtk::sinCos(S(angle / S(2)));
        const S b = S(2) * sine * sine / square;
        return std::array<S, 2>{b, S((S(1) - S(2) * sine * cosine / angle) / square)};
      });
}
/// Returns e of V^-1 for a squared angle up to pi^2.
template <class S>
S inverseScrewFactor(const S& square) {
  return mtk::detail::branch(
      square < S(kScrewSeries),
      [&] {
        static constexpr std::array<long double, 8> e{1.0L / 12,          1.0L / 720,
                                                      1.0L / 30240,       1.0L / 1209600,
                                                      1.0L / 47900160,    691.0L / 1307674368000,
                                                      1.0L / 74724249600, 3617.0L / 10670622842880000};
        return polynomialAt(e, square);
      },
      [&] {
        using std::sqrt;
        const S angle = sqrt(square);
        const auto [sine, cosine] = mtk::sinCos(S(angle / S(2)));
        return S((S(1) - angle * cosine / (S(2) * sine)) / square);
      });
}

/// Returns the motion after unit time with this twist.
template <class S>
mtk::trafo<mtk::SO3<S>> screwExp(const Twist<S>& twist) {
  const auto [b, c] = screwFactors<S>(twist.angular.squaredNorm());
  const auto turned = cross(twist.angular, twist.linear);
  return {mtk::SO3<S>::exp(twist.angular), twist.linear + b * turned + c * cross(twist.angular, turned)};
}
/// Returns the twist with the angle up to pi that leads to this motion in unit time.
template <class S>
Twist<S> screwLog(const mtk::trafo<mtk::SO3<S>>& T) {
  const mtk::vect<3, S> angular = mtk::SO3<S>::log(T.orient);
  const S e = inverseScrewFactor<S>(angular.squaredNorm());
  const auto turned = cross(angular, T.pos);
  return {T.pos - S(0.5) * turned + e * cross(angular, turned), angular};
}

/// Returns the twist seen in the frame that the motion T leads to: Ad(T^-1).
template <class S, class X>
auto seenAfter(const mtk::trafo<mtk::SO3<S>>& T, const Twist<X>& twist) {
  const auto back = T.orient.inverse();
  return Twist<mtk::promote_t<S, X>>{back * (twist.linear + cross(twist.angular, T.pos)),
                                     back * twist.angular};
}
/// Returns the Lie bracket [a, b] = ad(a) b.
template <class S>
Twist<S> bracket(const Twist<S>& a, const Twist<S>& b) {
  return {cross(a.angular, b.linear) + cross(a.linear, b.angular), cross(a.angular, b.angular)};
}

}  // namespace detail
}  // namespace slom::trajectory
