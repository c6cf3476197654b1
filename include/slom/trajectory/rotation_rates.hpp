/// Conversion between the motion of a rotation R(t) = R_0 exp(x(t)) and the motion of its rotation vector x(t).
///   w   angular velocity in the frame of the body: w = J(x) x'
///   a   its derivative by time: a = J(x) x'' + J'(x) x'
///   J   right Jacobian of SO(3): I - b [x]x + c [x]x^2 with b, c of screw.hpp; J^-1 = I + [x]x / 2 + e [x]x^2
///       J' x' = -b' x x x' + c' x x (x x x') + c x' x (x x x')
///   source  Sola, Deray, Atchuthan, "A micro Lie theory for state estimation in robotics", 2018, (143) and (144);
///           the derivative of J by time is exact, where Tang, Yoon, Barfoot 2019 take it to first order in x
#pragma once

#include <array>

#include "slom/trajectory/screw.hpp"

namespace slom::trajectory::detail {

/// Returns the derivatives of screwFactors by the squared angle.
template <class S>
std::array<S, 2> screwFactorSlopes(const S& square, const std::array<S, 2>& factors) {
  return mtk::detail::branch(
      square < S(kScrewSeries),
      [&] {
        static constexpr std::array<long double, 8> b{
            -1.0L / 24,        2.0L / 720,         -3.0L / 40320,          4.0L / 3628800,
            -5.0L / 479001600, 6.0L / 87178291200, -7.0L / 20922789888000, 8.0L / 6402373705728000};
        static constexpr std::array<long double, 8> c{
            -1.0L / 120,        2.0L / 5040,          -3.0L / 362880,          4.0L / 39916800,
            -5.0L / 6227020800, 6.0L / 1307674368000, -7.0L / 355687428096000, 8.0L / 121645100408832000};
        return std::array<S, 2>{polynomialAt(b, square), polynomialAt(c, square)};
      },
      [&] {
        const auto& [b, c] = factors;
        return std::array<S, 2>{S((S(0.5) - b - c * square / S(2)) / square),
                                S((b - S(3) * c) / (S(2) * square))};
      });
}

/// Returns J(x) rate.
template <class S>
mtk::vect<3, S> angularVelocity(const mtk::vect<3, S>& x, const mtk::vect<3, S>& rate) {
  const auto [b, c] = screwFactors<S>(x.squaredNorm());
  const auto turned = cross(x, rate);
  return rate - b * turned + c * cross(x, turned);
}
/// Returns J^-1(x) w.
template <class S>
mtk::vect<3, S> vectorRate(const mtk::vect<3, S>& x, const mtk::vect<3, S>& w) {
  const S e = inverseScrewFactor<S>(x.squaredNorm());
  const auto turned = cross(x, w);
  return w + S(0.5) * turned + e * cross(x, turned);
}
/// Returns J'(x) x' for the rate x'.
template <class S>
mtk::vect<3, S> jacobianRate(const mtk::vect<3, S>& x, const mtk::vect<3, S>& rate) {
  const S square = x.squaredNorm(), twice = S(2) * x.dot(rate);
  const auto factors = screwFactors<S>(square);
  const auto slopes = screwFactorSlopes<S>(square, factors);
  const auto turned = cross(x, rate);
  return twice * (slopes[1] * cross(x, turned) - slopes[0] * turned) + factors[1] * cross(rate, turned);
}

}  // namespace slom::trajectory::detail
