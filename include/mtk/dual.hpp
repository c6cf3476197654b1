/// Numbers that carry their derivatives: forward-mode automatic differentiation.
///   state    a value v and its partial derivatives d with respect to N columns (unknowns)
///   f(v, d)  = (f(v), f'(v) d), the chain rule
///   source   Griewank and Walther, "Evaluating derivatives", 2008, chapter 3
/// If a derivative is infinite (sqrt at 0, acos at 1) and the partial derivative of the argument is zero, the result is
/// zero. So sqrt(x * x) at 0, |R - R| and similar terms have finite derivatives.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

#include <Eigen/Core>

#include "mtk/detail/lanes.hpp"
#include "mtk/scalar.hpp"

namespace mtk {

namespace detail {

constexpr int countColumns(std::uint64_t columns) { return std::popcount(columns); }
/// Returns the bits 0 .. n - 1.
constexpr std::uint64_t lowColumns(int n) {
  return n >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << n) - 1;
}
/// Returns the number of the i-th column in the set.
constexpr int columnAt(std::uint64_t columns, int i) {
  for (; i > 0; --i) columns &= columns - 1;
  return std::countr_zero(columns);
}
/// Returns the index of a column of the set among the set's members.
constexpr int placeOf(std::uint64_t columns, int column) {
  return std::popcount(columns & lowColumns(column));
}

constexpr bool isIn(std::uint64_t columns, int column) { return ((columns >> column) & 1) != 0; }
/// Returns placeOf(columns, column), or 0 if the column is not in the set.
constexpr int placeIn(std::uint64_t columns, int column) {
  return isIn(columns, column) ? placeOf(columns, column) : 0;
}

/// Partial derivatives with respect to the columns in the set C. All others are zero.
template <class S, std::uint64_t C>
using Partials = Lanes<S, countColumns(C)>;

/// Computes both(a, b), left(a) or right(b) for each column of either set.
template <std::uint64_t A, std::uint64_t B, class S, class Both, class Left, class Right>
Partials<S, A | B> combine(const Partials<S, A>& a, const Partials<S, B>& b, const Both& both,
                           [[maybe_unused]] const Left& left, [[maybe_unused]] const Right& right) {
  if constexpr (A == B) {
    Partials<S, A> r;
    MTK_EACH_VECTOR(r.count, i, r.v[i] = both(a.v[i], b.v[i]));
    return r;
  } else {
    Partials<S, A | B> r;
    if constexpr (r.lanes > 1) r.v[r.count - 1] = typename Partials<S, A | B>::Vector{};  // unused lanes
    // The choice among the three is a constant for each I and needs no function for each.
    [&]<int... I>(std::integer_sequence<int, I...>) {
      (r.set(I, isIn(A, columnAt(A | B, I)) && isIn(B, columnAt(A | B, I))
                    ? S(both(a.get(placeIn(A, columnAt(A | B, I))), b.get(placeIn(B, columnAt(A | B, I)))))
                : isIn(A, columnAt(A | B, I)) ? S(left(a.get(placeIn(A, columnAt(A | B, I)))))
                                              : S(right(b.get(placeIn(B, columnAt(A | B, I)))))),
       ...);
    }(std::make_integer_sequence<int, countColumns(A | B)>{});
    return r;
  }
}

/// Returns f(a) for each column of a.
template <class S, int N, class F>
Lanes<S, N> apply(const Lanes<S, N>& a, const F& f) {
  Lanes<S, N> r;
  MTK_EACH_VECTOR(r.count, i, r.v[i] = f(a.v[i]));
  return r;
}

/// Returns factor * a, and 0 where a is 0, for any factor.
template <class S, int N>
Lanes<S, N> scaledOrZero(const S& factor, const Lanes<S, N>& a) {
  Lanes<S, N> r = Lanes<S, N>::zero();
  for (int i = 0; i < N; ++i) r.set(i, select(a.get(i) == S(0), S(0), S(factor * a.get(i))));
  return r;
}

}  // namespace detail

/// A number whose partial derivatives are 0 except for the columns (bits) in C.
template <class S, std::uint64_t C>
class SparseDual {
 public:
  using Value = S;
  using Partials = detail::Partials<S, C>;
  static constexpr std::uint64_t columns = C;
  static constexpr int size = detail::countColumns(C);

  /// Leaves the number uninitialised, as for a double; `SparseDual()` is 0.
  SparseDual() = default;
  /// Converts a constant.
  template <class T>
    requires(std::is_arithmetic_v<T> || std::is_same_v<T, S>)
  SparseDual(const T& constant)
      : v_(S(constant)), d_(Partials::zero()) {}  // NOLINT(google-explicit-constructor)
  SparseDual(const S& value, const Partials& partials) : v_(value), d_(partials) {}
  /// Creates a number with the partial derivatives that make() returns, without copying them.
  template <class Make>
    requires requires(const Make& make) {
      { make() } -> std::same_as<Partials>;
    }
  SparseDual(const S& value, const Make& make) : v_(value), d_(make()) {}
  /// Converts to a number with more columns.
  template <std::uint64_t A>
    requires((A & ~C) == 0 && A != C)
  SparseDual(const SparseDual<S, A>& x) {  // NOLINT(google-explicit-constructor): nothing is lost
    *this = x;
  }
  template <std::uint64_t A>
    requires((A & ~C) == 0 && A != C)
  SparseDual& operator=(const SparseDual<S, A>& x) {
    v_ = x.value();
    if constexpr (Partials::lanes > 1) d_ = Partials::zero();
    [&]<int... I>(std::integer_sequence<int, I...>) {
      (d_.set(I, x.partial(detail::columnAt(C, I))), ...);
    }(std::make_integer_sequence<int, size>{});
    return *this;
  }

  /// Returns the number without its derivatives.
  const S& value() const { return v_; }
  /// Returns the derivatives with respect to the columns in C, in ascending order. All others are 0.
  const Partials& partials() const { return d_; }
  S& value() { return v_; }
  Partials& partials() { return d_; }
  /// Returns d / d column c.
  S partial(int c) const { return detail::isIn(C, c) ? d_.get(detail::placeOf(C, c)) : S(0); }
  /// Sets the value x and makes the number the unknown `column`, or a constant if the column is not in C.
  void seed(const S& x, int column) {
    v_ = x;
    const int place = column >= 0 && column < 64 && detail::isIn(C, column) ? detail::placeOf(C, column) : -1;
    d_ = Partials::generate([&](int i) { return i == place ? S(1) : S(0); });
  }

  template <class T>
  SparseDual& operator+=(const T& b) {
    return *this = *this + b;
  }
  template <class T>
  SparseDual& operator-=(const T& b) {
    return *this = *this - b;
  }
  template <class T>
  SparseDual& operator*=(const T& b) {
    return *this = *this * b;
  }
  template <class T>
  SparseDual& operator/=(const T& b) {
    return *this = *this / b;
  }

 private:
  S v_;
  Partials d_;
};

/// A number with N partial derivatives.
template <class S, int N>
using Dual = SparseDual<S, detail::lowColumns(N)>;

template <class S, std::uint64_t C>
  requires is_scalar_v<S>
inline constexpr bool is_scalar_v<SparseDual<S, C>> = true;

namespace detail {

/// A type that mixes with a dual number over S as a constant.
template <class T, class S>
concept ConstantFor = std::is_arithmetic_v<T> || std::is_same_v<T, S>;

/// Returns the function with value f and derivative df at x.
template <class S, std::uint64_t C>
SparseDual<S, C> chain(const SparseDual<S, C>& x, const S& f, const S& df) {
  return {f, [&] { return apply(x.partials(), [&](const auto& d) { return df * d; }); }};
}
/// Returns chain(x, f, df) for a df that may be infinite.
template <class S, std::uint64_t C>
SparseDual<S, C> chainOrZero(const SparseDual<S, C>& x, const S& f, const S& df) {
  if constexpr (std::is_floating_point_v<S>) {
    if (df - df == S(0)) return chain(x, f, df);
  }
  return {f, [&] { return scaledOrZero(df, x.partials()); }};
}
/// Returns the function with value f and derivatives da, db at (a, b).
template <class S, std::uint64_t A, std::uint64_t B>
SparseDual<S, A | B> chain(const SparseDual<S, A>& a, const SparseDual<S, B>& b, const S& f, const S& da,
                           const S& db) {
  return {f, [&] {
            return combine<A, B, S>(
                a.partials(), b.partials(), [&](const auto& x, const auto& y) { return da * x + db * y; },
                [&](const auto& x) { return da * x; }, [&](const auto& y) { return db * y; });
          }};
}

/// Returns chain(a, b, f, da, db) for da or db that may be infinite or undefined.
template <class S, std::uint64_t A, std::uint64_t B>
SparseDual<S, A | B> chainOrZero(const SparseDual<S, A>& a, const SparseDual<S, B>& b, const S& f,
                                 const S& da, const S& db) {
  const SparseDual<S, A> by_a(f, [&] { return scaledOrZero(da, a.partials()); });
  const SparseDual<S, B> by_b(S(0), [&] { return scaledOrZero(db, b.partials()); });
  return by_a + by_b;
}

/// Returns the reciprocal, or the largest number if there is none.
template <class S>
S boundedReciprocal(const S& x) {
  const S limit(std::numeric_limits<built_in_t<S>>::max());
  const S reciprocal = S(1) / x;
  return select(reciprocal <= limit, reciprocal, limit);
}

}  // namespace detail

template <class S, std::uint64_t C>
SparseDual<S, C> operator-(const SparseDual<S, C>& a) {
  return {-a.value(), [&] { return detail::apply(a.partials(), [](const auto& d) { return -d; }); }};
}
template <class S, std::uint64_t C>
SparseDual<S, C> operator+(const SparseDual<S, C>& a) {
  return a;
}
template <class S, std::uint64_t A, std::uint64_t B>
SparseDual<S, A | B> operator+(const SparseDual<S, A>& a, const SparseDual<S, B>& b) {
  const auto same = [](const auto& x) { return x; };
  const auto plus = [](const auto& x, const auto& y) { return x + y; };
  return {a.value() + b.value(),
          [&] { return detail::combine<A, B, S>(a.partials(), b.partials(), plus, same, same); }};
}
template <class S, std::uint64_t A, std::uint64_t B>
SparseDual<S, A | B> operator-(const SparseDual<S, A>& a, const SparseDual<S, B>& b) {
  return {a.value() - b.value(), [&] {
            return detail::combine<A, B, S>(
                a.partials(), b.partials(), [](const auto& x, const auto& y) { return x - y; },
                [](const auto& x) { return x; }, [](const auto& y) { return -y; });
          }};
}
template <class S, std::uint64_t A, std::uint64_t B>
SparseDual<S, A | B> operator*(const SparseDual<S, A>& a, const SparseDual<S, B>& b) {
  return detail::chain(a, b, S(a.value() * b.value()), b.value(), a.value());
}
template <class S, std::uint64_t A, std::uint64_t B>
SparseDual<S, A | B> operator/(const SparseDual<S, A>& a, const SparseDual<S, B>& b) {
  const S inverse = S(1) / b.value();
  const S quotient = a.value() * inverse;
  return detail::chain(a, b, quotient, inverse, S(-quotient * inverse));
}

template <class S, std::uint64_t C, detail::ConstantFor<S> T>
SparseDual<S, C> operator+(const SparseDual<S, C>& a, const T& b) {
  return {a.value() + S(b), a.partials()};
}
template <class S, std::uint64_t C, detail::ConstantFor<S> T>
SparseDual<S, C> operator+(const T& a, const SparseDual<S, C>& b) {
  return b + a;
}
template <class S, std::uint64_t C, detail::ConstantFor<S> T>
SparseDual<S, C> operator-(const SparseDual<S, C>& a, const T& b) {
  return {a.value() - S(b), a.partials()};
}
template <class S, std::uint64_t C, detail::ConstantFor<S> T>
SparseDual<S, C> operator-(const T& a, const SparseDual<S, C>& b) {
  return {S(a) - b.value(), [&] { return detail::apply(b.partials(), [](const auto& d) { return -d; }); }};
}
template <class S, std::uint64_t C, detail::ConstantFor<S> T>
SparseDual<S, C> operator*(const SparseDual<S, C>& a, const T& b) {
  return detail::chain(a, S(a.value() * S(b)), S(b));
}
template <class S, std::uint64_t C, detail::ConstantFor<S> T>
SparseDual<S, C> operator*(const T& a, const SparseDual<S, C>& b) {
  return b * a;
}
template <class S, std::uint64_t C, detail::ConstantFor<S> T>
SparseDual<S, C> operator/(const SparseDual<S, C>& a, const T& b) {
  return detail::chain(a, S(a.value() / S(b)), S(S(1) / S(b)));
}
template <class S, std::uint64_t C, detail::ConstantFor<S> T>
SparseDual<S, C> operator/(const T& a, const SparseDual<S, C>& b) {
  const S quotient = S(a) / b.value();
  return detail::chain(b, quotient, S(-quotient / b.value()));
}

// Comparisons of dual numbers compare their values.
#define MTK_COMPARE_DUALS(op)                                              \
  template <class S, std::uint64_t A, std::uint64_t B>                     \
  auto operator op(const SparseDual<S, A>& a, const SparseDual<S, B>& b) { \
    return a.value() op b.value();                                         \
  }                                                                        \
  template <class S, std::uint64_t C, detail::ConstantFor<S> T>            \
  auto operator op(const SparseDual<S, C>& a, const T& b) {                \
    return a.value() op S(b);                                              \
  }                                                                        \
  template <class S, std::uint64_t C, detail::ConstantFor<S> T>            \
  auto operator op(const T& a, const SparseDual<S, C>& b) {                \
    return S(a) op b.value();                                              \
  }
MTK_COMPARE_DUALS(==)
MTK_COMPARE_DUALS(!=)
MTK_COMPARE_DUALS(<)
MTK_COMPARE_DUALS(<=)
MTK_COMPARE_DUALS(>)
MTK_COMPARE_DUALS(>=)
#undef MTK_COMPARE_DUALS

/// Selects lane by lane, for dual numbers over packs.
template <class Mask, class S, std::uint64_t C>
  requires(!std::is_same_v<Mask, bool>)
SparseDual<S, C> select(const Mask& mask, const SparseDual<S, C>& a, const SparseDual<S, C>& b) {
  detail::Partials<S, C> d;
  detail::unrolled<detail::Partials<S, C>::count>(
      [&](int i) { d.v[i] = select(mask, a.partials().v[i], b.partials().v[i]); });
  return {select(mask, a.value(), b.value()), d};
}

}  // namespace mtk

#include "mtk/dual_functions.hpp"

namespace Eigen {

template <class S, std::uint64_t C>
struct NumTraits<mtk::SparseDual<S, C>> {
  using Real = mtk::SparseDual<S, C>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = mtk::detail::built_in_t<S>;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1 + mtk::SparseDual<S, C>::size,
    AddCost = 1 + mtk::SparseDual<S, C>::size,
    MulCost = 3 * (1 + mtk::SparseDual<S, C>::size)
  };
  static Literal epsilon() { return NumTraits<Literal>::epsilon(); }
  static Literal dummy_precision() { return NumTraits<Literal>::dummy_precision(); }
  static Literal highest() { return NumTraits<Literal>::highest(); }
  static Literal lowest() { return NumTraits<Literal>::lowest(); }
  static int digits10() { return NumTraits<Literal>::digits10(); }
};

template <class T, class S, std::uint64_t C, class Op>
  requires mtk::detail::ConstantFor<T, S>
struct ScalarBinaryOpTraits<T, mtk::SparseDual<S, C>, Op> {
  using ReturnType = mtk::SparseDual<S, C>;
};
template <class T, class S, std::uint64_t C, class Op>
  requires mtk::detail::ConstantFor<T, S>
struct ScalarBinaryOpTraits<mtk::SparseDual<S, C>, T, Op> {
  using ReturnType = mtk::SparseDual<S, C>;
};
template <class S, std::uint64_t A, std::uint64_t B, class Op>
  requires(A != B)
struct ScalarBinaryOpTraits<mtk::SparseDual<S, A>, mtk::SparseDual<S, B>, Op> {
  using ReturnType = mtk::SparseDual<S, A | B>;
};

}  // namespace Eigen
