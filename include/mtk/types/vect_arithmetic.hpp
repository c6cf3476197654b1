/// Sums, differences and multiples of vectors, as values. Eigen's operators return expressions that refer to their
/// operands. With them, a function `auto f(...) { return T * p - z; }` would return a reference to the temporary T * p.
#pragma once

#include <type_traits>

#include <Eigen/Core>

#include "mtk/detail/lanes.hpp"
#include "mtk/manifold.hpp"
#include "mtk/scalar.hpp"
#include "mtk/types/vect.hpp"

namespace mtk {

namespace detail {
/// Returns a vector of type V whose `size` entries are not set yet.
template <class V>
V unfilled(Eigen::Index size) {
  if constexpr (V::DOF == Dynamic) {
    return V(size);
  } else {
    return V(Uninitialized());
  }
}

template <class A, class B>
concept Summable = bool(A::IsVectorAtCompileTime) && bool(B::IsVectorAtCompileTime) &&
                   requires { typename promote_t<typename A::Scalar, typename B::Scalar>; };
/// The sum of an A and a B; its size is that of the operand of fixed size, if any.
template <class A, class B>
using Sum = vect<(A::SizeAtCompileTime == Dynamic ? int(B::SizeAtCompileTime) : int(A::SizeAtCompileTime)),
                 promote_t<typename A::Scalar, typename B::Scalar>>;
template <class A, class B, class Op>
Sum<A, B> entrywise(const A& a, const B& b, const char* name, const Op& op) {
  static_assert(int(A::SizeAtCompileTime) == int(B::SizeAtCompileTime) || A::SizeAtCompileTime == Dynamic ||
                    B::SizeAtCompileTime == Dynamic,
                "mtk: vectors of different sizes cannot be added or subtracted");
  requireSameSize(a, b, name);
  auto result = unfilled<Sum<A, B>>(a.size());
  forEachEntry<Sum<A, B>::DOF>(a.size(), [&](int i) { result[i] = op(a[i], b[i]); });
  return result;
}
inline constexpr auto plus = [](const auto& a, const auto& b) { return a + b; };
inline constexpr auto minus = [](const auto& a, const auto& b) { return a - b; };
}  // namespace detail

template <int N, class A, int M, class B>
auto operator+(const vect<N, A>& a, const vect<M, B>& b) {
  return detail::entrywise(a, b, "a + b", detail::plus);
}
template <int N, class A, int M, class B>
auto operator-(const vect<N, A>& a, const vect<M, B>& b) {
  return detail::entrywise(a, b, "a - b", detail::minus);
}
template <int N, class S, class D>
  requires detail::Summable<vect<N, S>, D>
auto operator+(const vect<N, S>& a, const Eigen::MatrixBase<D>& b) {
  return detail::entrywise(a, b.derived().eval(), "a + b", detail::plus);
}
template <int N, class S, class D>
  requires detail::Summable<vect<N, S>, D>
auto operator-(const vect<N, S>& a, const Eigen::MatrixBase<D>& b) {
  return detail::entrywise(a, b.derived().eval(), "a - b", detail::minus);
}
template <int N, class S, class D>
  requires detail::Summable<vect<N, S>, D>
auto operator+(const Eigen::MatrixBase<D>& a, const vect<N, S>& b) {
  return detail::entrywise(a.derived().eval(), b, "a + b", detail::plus);
}
template <int N, class S, class D>
  requires detail::Summable<vect<N, S>, D>
auto operator-(const Eigen::MatrixBase<D>& a, const vect<N, S>& b) {
  return detail::entrywise(a.derived().eval(), b, "a - b", detail::minus);
}
namespace detail {
template <int N, class S, class Op>
auto scaled(const vect<N, S>& a, const Op& op) {
  auto result = unfilled<vect<N, decltype(op(a[0]))>>(a.size());
  forEachEntry<N>(a.size(), [&](int i) { result[i] = op(a[i]); });
  return result;
}
/// A number type other than S, where at most one of the two is built in.
template <class T, class S>
concept OtherScalar =
    !std::is_same_v<T, S> &&
    (is_scalar_v<T> || std::is_arithmetic_v<T>)&&!(std::is_arithmetic_v<T> && std::is_arithmetic_v<S>);
}  // namespace detail

template <int N, class S>
vect<N, S> operator-(const vect<N, S>& a) {
  return detail::scaled(a, [](const S& x) { return S(-x); });
}
template <int N, class S>
vect<N, S> operator*(const vect<N, S>& a, const std::type_identity_t<S>& factor) {
  return detail::scaled(a, [&](const S& x) { return x * factor; });
}
template <int N, class S>
vect<N, S> operator*(const std::type_identity_t<S>& factor, const vect<N, S>& a) {
  return detail::scaled(a, [&](const S& x) { return x * factor; });
}
template <int N, class S>
vect<N, S> operator/(const vect<N, S>& a, const std::type_identity_t<S>& divisor) {
  return detail::scaled(a, [&](const S& x) { return x / divisor; });
}
// Products with a built-in number of another type. The vector keeps its scalar type.
template <int N, class S, class T>
  requires(std::is_arithmetic_v<S> && std::is_arithmetic_v<T> && !std::is_same_v<S, T>)
vect<N, S> operator*(const vect<N, S>& a, const T& factor) {
  return a * S(factor);
}
template <int N, class S, class T>
  requires(std::is_arithmetic_v<S> && std::is_arithmetic_v<T> && !std::is_same_v<S, T>)
vect<N, S> operator*(const T& factor, const vect<N, S>& a) {
  return a * S(factor);
}
template <int N, class S, class T>
  requires(std::is_arithmetic_v<S> && std::is_arithmetic_v<T> && !std::is_same_v<S, T>)
vect<N, S> operator/(const vect<N, S>& a, const T& divisor) {
  return a / S(divisor);
}
// Products with a number of another type: vectors of numbers times dual numbers, or dual numbers of other unknowns.
template <int N, class S, class T>
  requires detail::OtherScalar<T, S>
vect<N, promote_t<S, T>> operator*(const vect<N, S>& a, const T& factor) {
  return detail::scaled(a, [&](const S& x) { return x * factor; });
}
template <int N, class S, class T>
  requires detail::OtherScalar<T, S>
vect<N, promote_t<S, T>> operator*(const T& factor, const vect<N, S>& a) {
  return detail::scaled(a, [&](const S& x) { return x * factor; });
}
template <int N, class S, class T>
  requires detail::OtherScalar<T, S>
vect<N, promote_t<S, T>> operator/(const vect<N, S>& a, const T& divisor) {
  return detail::scaled(a, [&](const S& x) { return x / divisor; });
}

}  // namespace mtk
