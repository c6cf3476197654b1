/// The functions of <cmath> for packs. All agree with the C library to a few units in the last place.
///   source   sin, cos: reduction after Cody and Waite, "Software manual for the elementary functions", 1980, with
///            Taylor series; atan2: the rational approximation of Moshier, Cephes library, atan.c; others lane by lane
///            from the C library
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

#include <Eigen/Core>

#include "mtk/pack.hpp"
#include "mtk/scalar.hpp"

namespace mtk {

namespace detail {

/// Returns f of each lane.
template <int W, class F>
Pack<W> laneByLane(const Pack<W>& a, const F& f) {
  Pack<W> r;
  for (int i = 0; i < W; ++i) r.set(i, f(a[i]));
  return r;
}
template <int W, class F>
Pack<W> laneByLane(const Pack<W>& a, const Pack<W>& b, const F& f) {
  Pack<W> r;
  for (int i = 0; i < W; ++i) r.set(i, f(a[i], b[i]));
  return r;
}
template <class Vector>
Vector vectorSqrt(const Vector& x) {
  if constexpr (std::is_same_v<Vector, double>) {
    return std::sqrt(x);
  } else if constexpr (requires { Eigen::internal::psqrt(x); } &&
                       sizeof(Vector) == EIGEN_MAX_STATIC_ALIGN_BYTES) {
    using Packet = typename Eigen::internal::packet_traits<double>::type;
    return reinterpret_cast<Vector>(Eigen::internal::psqrt(reinterpret_cast<Packet>(x)));
  } else {
    Vector r;
    for (std::size_t i = 0; i < sizeof(Vector) / sizeof(double); ++i) r[i] = std::sqrt(x[i]);
    return r;
  }
}

/// Returns c[0] + c[1] x + c[2] x^2 + ...
template <class S, std::size_t N>
S polynomial(const S& x, const double (&c)[N]) {
  S sum(c[N - 1]);
  for (std::size_t i = N - 1; i-- > 0;) sum = sum * x + S(c[i]);
  return sum;
}

template <int W>
Pack<W> roundToInteger(const Pack<W>& x) {
  const Pack<W> shift(6755399441055744.0);  // 3 * 2^51: the sum has no bits for fractions
  Pack<W> sum = x + shift;
#if defined(__GNUC__)
  MTK_EACH_VECTOR(Pack<W>::count, i, asm("" : "+m"(sum.lanes.v[i])));  // keeps -ffast-math from undoing it
#endif
  return sum - shift;
}

// Code for rare lanes, kept out of the inlined functions.
template <int W>
[[gnu::noinline]] void sinCosOfFar(const Pack<W>& x, const PackMask<W>& far, SinCos<Pack<W>>& result) {
  result.sine = select(far, laneByLane(x, [](double t) { return std::sin(t); }), result.sine);
  result.cosine = select(far, laneByLane(x, [](double t) { return std::cos(t); }), result.cosine);
}
template <int W>
[[gnu::noinline]] Pack<W> atan2ByLane(const Pack<W>& y, const Pack<W>& x) {
  return laneByLane(y, x, [](double a, double b) { return std::atan2(a, b); });
}

}  // namespace detail

template <int W>
Pack<W> sqrt(const Pack<W>& x) {
  Pack<W> r;
  MTK_EACH_VECTOR(Pack<W>::count, i, r.lanes.v[i] = detail::vectorSqrt(x.lanes.v[i]));
  return r;
}
template <int W>
Pack<W> abs(const Pack<W>& x) {
  return select(x < Pack<W>(0.0), -x, x);
}
/// Returns sin(x) and cos(x). For lanes beyond 10^5, where the reduction loses digits, the C library computes them.
template <int W>
SinCos<Pack<W>> sinCos(const Pack<W>& x) {
  constexpr double two_over_pi = 0.63661977236758134308;
  const Pack<W> turns = detail::roundToInteger(Pack<W>(x * two_over_pi));
  // pi/2 in three parts. The first two have trailing zeros, so their multiples are exact.
  const Pack<W> r = ((x - turns * 1.57079632673412561417e+00) - turns * 6.07710050630396597660e-11) -
                    turns * 2.02226624879595063154e-21;
  const Pack<W> r2 = r * r;
  static constexpr double s[] = {-1.0 / 6,        1.0 / 120,          -1.0 / 5040,           1.0 / 362880,
                                 -1.0 / 39916800, 1.0 / 6227020800.0, -1.0 / 1307674368000.0};
  static constexpr double c[] = {
      1.0 / 24,          -1.0 / 720,           1.0 / 40320,           -1.0 / 3628800,
      1.0 / 479001600.0, -1.0 / 87178291200.0, 1.0 / 20922789888000.0};
  const Pack<W> sin_r = r + r * r2 * detail::polynomial(r2, s);
  const Pack<W> half = r2 * 0.5;
  const Pack<W> cos_r = 1.0 - (half - r2 * r2 * detail::polynomial(r2, c));
  // Quadrant q = turns mod 4, one of -1, 0, 1, 2: odd ones swap sine and cosine.
  const Pack<W> q = turns - 4.0 * detail::roundToInteger(Pack<W>(turns * 0.25 - 0.0625));
  const PackMask<W> plus_one = q == Pack<W>(1.0), minus_one = q == Pack<W>(-1.0), two = q == Pack<W>(2.0);
  const Pack<W> a = select(plus_one || minus_one, cos_r, sin_r),
                b = select(plus_one || minus_one, sin_r, cos_r);
  SinCos<Pack<W>> result{select(minus_one || two, -a, a), select(plus_one || two, -b, b)};
  const PackMask<W> far = !((x <= Pack<W>(1e5)) && (x >= Pack<W>(-1e5)));
  if (any(far)) detail::sinCosOfFar(x, far, result);
  return result;
}
template <int W>
Pack<W> sin(const Pack<W>& x) {
  return sinCos(x).sine;
}
template <int W>
Pack<W> cos(const Pack<W>& x) {
  return sinCos(x).cosine;
}

#define MTK_PACK_FUNCTION(name)                                          \
  template <int W>                                                       \
  Pack<W> name(const Pack<W>& x) {                                       \
    return detail::laneByLane(x, [](double t) { return std::name(t); }); \
  }
MTK_PACK_FUNCTION(cbrt)
MTK_PACK_FUNCTION(exp)
MTK_PACK_FUNCTION(expm1)
MTK_PACK_FUNCTION(log)
MTK_PACK_FUNCTION(log1p)
MTK_PACK_FUNCTION(log2)
MTK_PACK_FUNCTION(log10)
MTK_PACK_FUNCTION(tan)
MTK_PACK_FUNCTION(asin)
MTK_PACK_FUNCTION(acos)
MTK_PACK_FUNCTION(sinh)
MTK_PACK_FUNCTION(cosh)
MTK_PACK_FUNCTION(tanh)
MTK_PACK_FUNCTION(asinh)
MTK_PACK_FUNCTION(acosh)
MTK_PACK_FUNCTION(atanh)
MTK_PACK_FUNCTION(erf)
MTK_PACK_FUNCTION(erfc)
MTK_PACK_FUNCTION(floor)
MTK_PACK_FUNCTION(ceil)
MTK_PACK_FUNCTION(round)
MTK_PACK_FUNCTION(trunc)
#undef MTK_PACK_FUNCTION

/// Returns the angle of (x, y) in [-pi, pi]; -0 counts as +0.
template <int W>
Pack<W> atan2(const Pack<W>& y, const Pack<W>& x) {
  using P = Pack<W>;
  // The angle in the first octant, minus pi/4 if it is nearer to that: t = tan of the remainder, |t| <= tan(pi/8).
  const P width = abs(x), height = abs(y);
  const PackMask<W> steep = height > width;
  const P small = select(steep, width, height), large = select(steep, height, width);
  const PackMask<W> beyond = small > large * 0.4142135623730950488;
  P divisor = select(beyond, P(small + large), large);
  divisor = select(divisor == P(0.0), P(1.0), divisor);
  const P t = select(beyond, P(small - large), small) / divisor;
  const P z = t * t;
  static constexpr double p[] = {-6.485021904942025371773e1, -1.228866684490136173410e2,
                                 -7.500855792314704667340e1, -1.615753718733365076637e1,
                                 -8.750608600031904122785e-1};
  static constexpr double q[] = {1.945506571482613964425e2, 4.853903996359136964868e2,
                                 4.328810604912902668951e2, 1.650270098316988542046e2,
                                 2.485846490142306297962e1, 1.0};
  const P correction = t * z * detail::polynomial(z, p) / detail::polynomial(z, q);
  P angle = select(beyond, P(0.78539816339744830962 + (t + (correction + 3.061616997868382943e-17))),
                   P(t + correction));
  angle = select(steep, P(1.57079632679489661923 - (angle - 6.123233995736765886e-17)), angle);
  angle = select(x < P(0.0), P(3.14159265358979323846 - (angle - 1.2246467991473531772e-16)), angle);
  angle = select(y < P(0.0), -angle, angle);
  const PackMask<W> ordinary = large <= P(std::numeric_limits<double>::max());
  if (all(ordinary)) return angle;
  return select(ordinary, angle, detail::atan2ByLane(y, x));
}
template <int W>
Pack<W> atan(const Pack<W>& x) {
  return detail::laneByLane(x, [](double t) { return std::atan(t); });
}
template <int W>
Pack<W> hypot(const Pack<W>& x, const Pack<W>& y) {
  return detail::laneByLane(x, y, [](double a, double b) { return std::hypot(a, b); });
}
template <int W>
Pack<W> pow(const Pack<W>& x, const Pack<W>& y) {
  return detail::laneByLane(x, y, [](double a, double b) { return std::pow(a, b); });
}
// Functions of a pack and a number common to all lanes.
#define MTK_PACK_AND_NUMBER(name)              \
  template <int W, class T>                    \
    requires std::is_arithmetic_v<T>           \
  Pack<W> name(const Pack<W>& x, const T& y) { \
    return name(x, Pack<W>(y));                \
  }                                            \
  template <int W, class T>                    \
    requires std::is_arithmetic_v<T>           \
  Pack<W> name(const T& x, const Pack<W>& y) { \
    return name(Pack<W>(x), y);                \
  }
MTK_PACK_AND_NUMBER(pow)
MTK_PACK_AND_NUMBER(atan2)
MTK_PACK_AND_NUMBER(hypot)
#undef MTK_PACK_AND_NUMBER

/// Returns the angle in [-pi, pi) that differs by whole turns. Exact for angles of any size.
template <int W>
Pack<W> reducedAngle(const Pack<W>& a) {
  return detail::laneByLane(a, [](double t) { return detail::reducedAngle(t); });
}

}  // namespace mtk
