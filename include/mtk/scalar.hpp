/// Numbers for coordinates: built-in ones, dual numbers (dual.hpp), SIMD packs (pack.hpp).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <type_traits>

#include "mtk/error.hpp"

namespace mtk {

/// True for real numbers that can be coordinates. Number types that are not built in specialise it.
template <class S>
inline constexpr bool is_scalar_v = std::is_floating_point_v<S>;

/// A number with its partial derivatives; see dual.hpp.
template <class S, std::uint64_t Columns>
class SparseDual;

/// Several numbers that operations process at once; see pack.hpp.
template <int Width>
class Pack;

namespace detail {

/// The built-in number type that S is made of.
template <class S>
struct BuiltIn {
  using type = S;
};
template <class S, std::uint64_t C>
struct BuiltIn<SparseDual<S, C>> : BuiltIn<S> {};
template <int W>
struct BuiltIn<Pack<W>> {
  using type = double;
};
template <class S>
using built_in_t = typename BuiltIn<S>::type;

template <class S>
inline constexpr built_in_t<S> epsilon = std::numeric_limits<built_in_t<S>>::epsilon();

template <class S>
inline constexpr bool is_dual = false;
template <class S, std::uint64_t C>
inline constexpr bool is_dual<SparseDual<S, C>> = true;

/// The type of a sum of an A and a B.
template <class A, class B>
struct Promote;
template <class A>
struct Promote<A, A> {
  using type = A;
};
template <class A, class B>
  requires(std::is_arithmetic_v<A> && !std::is_arithmetic_v<B>)
struct Promote<A, B> {
  using type = B;
};
template <class A, class B>
  requires(!std::is_arithmetic_v<A> && std::is_arithmetic_v<B>)
struct Promote<A, B> {
  using type = A;
};
template <class A, class B>
  requires(std::is_arithmetic_v<A> && std::is_arithmetic_v<B> && !std::is_same_v<A, B>)
struct Promote<A, B> {
  using type = std::common_type_t<A, B>;
};
template <int W, class S, std::uint64_t C>
struct Promote<Pack<W>, SparseDual<S, C>> {
  using type = SparseDual<S, C>;
};
template <int W, class S, std::uint64_t C>
struct Promote<SparseDual<S, C>, Pack<W>> {
  using type = SparseDual<S, C>;
};
template <class S, std::uint64_t A, std::uint64_t B>
  requires(A != B)
struct Promote<SparseDual<S, A>, SparseDual<S, B>> {
  using type = SparseDual<S, A | B>;
};

template <class A, class... B>
struct PromoteAll {
  using type = A;
};
template <class A, class B, class... C>
struct PromoteAll<A, B, C...> : PromoteAll<typename Promote<A, B>::type, C...> {};

}  // namespace detail

/// The type that holds both an A and a B.
template <class A, class B>
using promote_t = typename detail::Promote<A, B>::type;

/// Returns `condition ? a : b`, for packs lane by lane.
template <class S>
S select(bool condition, const S& a, const S& b) {
  return condition ? a : b;
}

/// Sine and cosine of one number.
template <class S>
struct SinCos {
  S sine, cosine;
};
/// Returns sin(x) and cos(x) together. This saves time for packs and for dual numbers, where each is the derivative of
/// the other.
template <class S>
SinCos<S> sinCos(const S& x) {
  using std::cos;
  using std::sin;
  return {sin(x), cos(x)};
}

namespace detail {

template <class Mask, class S, std::size_t N>
std::array<S, N> selectResult(const Mask& mask, const std::array<S, N>& a, const std::array<S, N>& b) {
  std::array<S, N> result;
  for (std::size_t i = 0; i < N; ++i) result[i] = select(mask, a[i], b[i]);
  return result;
}
template <class Mask, class S>
S selectResult(const Mask& mask, const S& a, const S& b) {
  return select(mask, a, b);
}

/// Returns `yes()` if the condition holds, otherwise `no()`. With packs, both may be evaluated, and each lane takes its
/// own result.
template <class Condition, class Yes, class No>
auto branch(const Condition& condition, const Yes& yes, const No& no) {
  if constexpr (std::is_same_v<Condition, bool>) {
    return condition ? yes() : no();
  } else {
    if (all(condition)) return yes();
    const auto other = no();
    return any(condition) ? selectResult(condition, yes(), other) : other;
  }
}

/// Returns whether the condition holds, in all lanes of a pack.
template <class Condition>
bool allOf(const Condition& condition) {
  if constexpr (std::is_same_v<Condition, bool>) {
    return condition;
  } else {
    return all(condition);
  }
}
/// Returns the number, or for a pack the number in the first lane where the condition does not hold.
template <class Condition, class S>
double firstWithout(const Condition& condition, const S& x) {
  if constexpr (std::is_same_v<Condition, bool>) {
    return static_cast<double>(x);
  } else {
    int lane = 0;
    while (condition[lane]) ++lane;
    return x[lane];
  }
}

/// Returns the angle in [-pi, pi) that differs from `a` by whole turns. Exact for angles of any size; NaN for infinite
/// ones.
template <class S>
  requires std::is_floating_point_v<S>
S reducedAngle(const S& a) {
  const S reduced = std::atan2(std::sin(a), std::cos(a));
  constexpr S half = S(3.141592653589793238462643383279502884L);
  return reduced >= half ? -half : reduced;
}

}  // namespace detail
}  // namespace mtk
