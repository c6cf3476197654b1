/// The functions of <cmath> for numbers that carry their derivatives.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "mtk/dual.hpp"

namespace mtk {

// Functions. `f` is the value, `df` the derivative, `x` the argument's value.
#define MTK_DUAL_FUNCTION(name, derivative)                 \
  template <class S, std::uint64_t C>                       \
  SparseDual<S, C> name(const SparseDual<S, C>& argument) { \
    using std::cosh;                                        \
    using std::exp;                                         \
    using std::name;                                        \
    using std::sinh;                                        \
    using std::sqrt;                                        \
    const S& x = argument.value();                          \
    const S f = name(x);                                    \
    return derivative;                                      \
  }
MTK_DUAL_FUNCTION(sqrt, detail::chainOrZero(argument, f, S(S(0.5) / f)))
MTK_DUAL_FUNCTION(cbrt, detail::chainOrZero(argument, f, S(S(1) / (S(3) * f * f))))
MTK_DUAL_FUNCTION(exp, detail::chain(argument, f, f))
MTK_DUAL_FUNCTION(expm1, detail::chain(argument, f, S(f + S(1))))
MTK_DUAL_FUNCTION(log, detail::chainOrZero(argument, f, S(S(1) / x)))
MTK_DUAL_FUNCTION(log1p, detail::chainOrZero(argument, f, S(S(1) / (S(1) + x))))
MTK_DUAL_FUNCTION(log2, detail::chainOrZero(argument, f, S(S(1.4426950408889634073599246810018921L) / x)))
MTK_DUAL_FUNCTION(log10, detail::chainOrZero(argument, f, S(S(0.4342944819032518276511289189166051L) / x)))
MTK_DUAL_FUNCTION(tan, detail::chain(argument, f, S(S(1) + f * f)))
MTK_DUAL_FUNCTION(asin, detail::chainOrZero(argument, f, S(S(1) / sqrt(S((S(1) - x) * (S(1) + x))))))
MTK_DUAL_FUNCTION(acos, detail::chainOrZero(argument, f, S(S(-1) / sqrt(S((S(1) - x) * (S(1) + x))))))
MTK_DUAL_FUNCTION(atan, detail::chain(argument, f, S(S(1) / (S(1) + x * x))))
MTK_DUAL_FUNCTION(sinh, detail::chain(argument, f, S(cosh(x))))
MTK_DUAL_FUNCTION(cosh, detail::chain(argument, f, S(sinh(x))))
MTK_DUAL_FUNCTION(tanh, detail::chain(argument, f, S((S(1) - f) * (S(1) + f))))
MTK_DUAL_FUNCTION(asinh, detail::chain(argument, f, S(S(1) / sqrt(S(S(1) + x * x)))))
MTK_DUAL_FUNCTION(acosh, detail::chainOrZero(argument, f, S(S(1) / sqrt(S((x - S(1)) * (x + S(1)))))))
MTK_DUAL_FUNCTION(atanh, detail::chainOrZero(argument, f, S(S(1) / ((S(1) - x) * (S(1) + x)))))
MTK_DUAL_FUNCTION(erf,
                  detail::chain(argument, f, S(S(1.1283791670955125738961589031215452L) * exp(S(-x * x)))))
MTK_DUAL_FUNCTION(erfc,
                  detail::chain(argument, f, S(S(-1.1283791670955125738961589031215452L) * exp(S(-x * x)))))
MTK_DUAL_FUNCTION(floor, (SparseDual<S, C>(f)))
MTK_DUAL_FUNCTION(ceil, (SparseDual<S, C>(f)))
MTK_DUAL_FUNCTION(round, (SparseDual<S, C>(f)))
MTK_DUAL_FUNCTION(trunc, (SparseDual<S, C>(f)))
#undef MTK_DUAL_FUNCTION

/// Returns |a|. At 0 the derivative is 0, the middle of the possible slopes.
template <class S, std::uint64_t C>
SparseDual<S, C> abs(const SparseDual<S, C>& a) {
  const S slope = select(a.value() < S(0), S(-1), select(a.value() > S(0), S(1), S(0)));
  return detail::chain(a, S(slope * a.value()), slope);
}
template <class S, std::uint64_t C>
SparseDual<S, C> fabs(const SparseDual<S, C>& a) {
  return abs(a);
}
template <class S, std::uint64_t C>
SparseDual<S, C> abs2(const SparseDual<S, C>& a) {
  return a * a;
}

/// Returns sine and cosine, each from the derivative of the other.
template <class S, std::uint64_t C>
SinCos<SparseDual<S, C>> sinCos(const SparseDual<S, C>& x) {
  const auto [sine, cosine] = sinCos(x.value());
  return {detail::chain(x, sine, cosine), detail::chain(x, cosine, S(-sine))};
}
template <class S, std::uint64_t C>
SparseDual<S, C> sin(const SparseDual<S, C>& x) {
  const auto [sine, cosine] = sinCos(x.value());
  return detail::chain(x, sine, cosine);
}
template <class S, std::uint64_t C>
SparseDual<S, C> cos(const SparseDual<S, C>& x) {
  const auto [sine, cosine] = sinCos(x.value());
  return detail::chain(x, cosine, S(-sine));
}

/// Returns the angle of (x, y). At (0, 0), where there is no derivative, the result has derivative 0.
template <class S, std::uint64_t A, std::uint64_t B>
SparseDual<S, A | B> atan2(const SparseDual<S, A>& y, const SparseDual<S, B>& x) {
  using std::abs;
  using std::atan2;
  const S square = y.value() * y.value() + x.value() * x.value();
  const auto [by_y, by_x] = detail::branch(
      square > S(1e-30) && square < S(1e30),  // in the range of float, too
      [&] {
        const S inverse = S(1) / square;
        return std::array<S, 2>{x.value() * inverse, -y.value() * inverse};
      },
      [&] {  // squares may be 0 or infinite
        const S a = abs(y.value()), b = abs(x.value()), largest = select(a > b, a, b);
        const S size = select(largest > S(0), largest, S(1));
        const S u = x.value() / size, v = y.value() / size, norm = (u * u + v * v) * size;
        const S inverse = select(norm > S(0), detail::boundedReciprocal(norm), S(0));
        return std::array<S, 2>{u * inverse, -v * inverse};
      });
  return detail::chain(y, x, S(atan2(y.value(), x.value())), by_y, by_x);
}
template <class S, std::uint64_t C, detail::ConstantFor<S> T>
SparseDual<S, C> atan2(const SparseDual<S, C>& y, const T& x) {
  return atan2(y, SparseDual<S, C>(x));
}
template <class S, std::uint64_t C, detail::ConstantFor<S> T>
SparseDual<S, C> atan2(const T& y, const SparseDual<S, C>& x) {
  return atan2(SparseDual<S, C>(y), x);
}

/// Returns sqrt(x^2 + y^2). At (0, 0), where there is no derivative, the result has derivative 0.
template <class S, std::uint64_t A, std::uint64_t B>
SparseDual<S, A | B> hypot(const SparseDual<S, A>& x, const SparseDual<S, B>& y) {
  using std::hypot;
  const S f = hypot(x.value(), y.value());
  const S size = select(f > S(0), f, S(1));
  return detail::chain(x, y, f, S(x.value() / size), S(y.value() / size));
}
template <class S, std::uint64_t C, detail::ConstantFor<S> T>
SparseDual<S, C> hypot(const SparseDual<S, C>& x, const T& y) {
  return hypot(x, SparseDual<S, C>(y));
}
template <class S, std::uint64_t C, detail::ConstantFor<S> T>
SparseDual<S, C> hypot(const T& x, const SparseDual<S, C>& y) {
  return hypot(SparseDual<S, C>(x), y);
}

template <class S, std::uint64_t C, detail::ConstantFor<S> T>
SparseDual<S, C> pow(const SparseDual<S, C>& base, const T& exponent) {
  using std::pow;
  const S p(exponent);
  const S slope = select(p == S(0), S(0), S(p * pow(base.value(), S(p - S(1)))));
  return detail::chainOrZero(base, S(pow(base.value(), p)), slope);
}
template <class S, std::uint64_t C, detail::ConstantFor<S> T>
SparseDual<S, C> pow(const T& base, const SparseDual<S, C>& exponent) {
  using std::log;
  using std::pow;
  const S f = pow(S(base), exponent.value());
  return detail::chainOrZero(exponent, f, select(f == S(0), S(0), S(f * log(S(base)))));
}
template <class S, std::uint64_t A, std::uint64_t B>
SparseDual<S, A | B> pow(const SparseDual<S, A>& base, const SparseDual<S, B>& exponent) {
  using std::log;
  using std::pow;
  const S f = pow(base.value(), exponent.value());
  const S slope = select(exponent.value() == S(0), S(0),
                         S(exponent.value() * pow(base.value(), S(exponent.value() - S(1)))));
  // A negative base has no derivative with respect to the exponent; a constant exponent does not need it.
  return detail::chainOrZero(base, exponent, f, slope, select(f == S(0), S(0), S(f * log(base.value()))));
}

template <class S, std::uint64_t C>
SparseDual<S, C> fmax(const SparseDual<S, C>& a, const SparseDual<S, C>& b) {
  return select(a.value() < b.value(), b, a);
}
template <class S, std::uint64_t C>
SparseDual<S, C> fmin(const SparseDual<S, C>& a, const SparseDual<S, C>& b) {
  return select(b.value() < a.value(), b, a);
}
template <class S, std::uint64_t C>
auto isfinite(const SparseDual<S, C>& a) {
  using std::isfinite;
  return isfinite(a.value());
}
template <class S, std::uint64_t C>
auto isnan(const SparseDual<S, C>& a) {
  using std::isnan;
  return isnan(a.value());
}
template <class S, std::uint64_t C>
auto isinf(const SparseDual<S, C>& a) {
  using std::isinf;
  return isinf(a.value());
}

}  // namespace mtk
