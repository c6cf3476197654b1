/// R^N: a column vector that knows how to be a variable.
///   state    N scalars; mtk::Dynamic for a size known only at run time
///   tangent  the same N numbers; x [+] d = x + d, y [-] x = y - x
///   names    x, y, z for N = 2 and 3, otherwise 0, 1, ...
/// Derive from it to give the numbers a meaning: `struct Camera : mtk::vect<9> { ... };`. A derived type can
/// name its components: `static constexpr std::array<std::string_view, 9> component_names{"fx", ...};`
#pragma once

#include <cstddef>
#include <initializer_list>
#include <tuple>

#include "mtk/detail/lanes.hpp"
#include "mtk/manifold.hpp"

namespace mtk {

namespace detail {
/// Whether an Eigen vector may have N entries.
template <class D, int N>
inline constexpr bool fits =
    bool(D::IsVectorAtCompileTime) &&
    (N == Dynamic || D::SizeAtCompileTime == Dynamic || int(D::SizeAtCompileTime) == N);
template <class D, int N>
  requires(!bool(D::IsVectorAtCompileTime))
inline constexpr bool fits<D, N> = D::SizeAtCompileTime == Dynamic;
}  // namespace detail

/// Says that what is constructed is about to be filled.
struct Uninitialized {};

template <int N, class S = double>
class vect : public PlainVector<S, N> {
 public:
  using Base = PlainVector<S, N>;
  using scalar = S;
  static constexpr int DOF = N;

  /// All entries are still to be set.
  explicit vect(Uninitialized)
    requires(N != Dynamic)
  {}
  /// All zero; of size 0 when N is Dynamic.
  vect() {
    if constexpr (N != Dynamic) {
      for (int i = 0; i < N; ++i) {
        if constexpr (requires { this->coeffRef(i).seed(0, -1); }) {
          this->coeffRef(i).seed(0, -1);
        } else {
          this->coeffRef(i) = S(0);
        }
      }
    }
  }
  template <class D>
    requires(std::is_same_v<typename D::Scalar, S> && detail::fits<D, N>)
  vect(const Eigen::MatrixBase<D>& v) : Base(v) {}  // NOLINT(google-explicit-constructor): as Eigen's vectors
  /// From coordinates of another type that loses nothing: constants among dual numbers.
  template <class D>
    requires(!std::is_same_v<typename D::Scalar, S> && !std::is_arithmetic_v<S> &&
             std::is_convertible_v<typename D::Scalar, S> && detail::fits<D, N>)
  vect(const Eigen::MatrixBase<D>& v) : Base(v.size()) {  // NOLINT(google-explicit-constructor)
    for (Eigen::Index i = 0; i < v.size(); ++i) this->coeffRef(i) = S(v.derived()[i]);
  }
  /// Derivatives do not get lost on the way into numbers without them: a function of Eigen::Vector3d does not accept
  /// a vector of dual numbers.
  template <class D>
    requires(!std::is_arithmetic_v<S> && std::is_base_of_v<Eigen::PlainObjectBase<D>, D> &&
             std::is_arithmetic_v<typename D::Scalar>)
  operator D() const = delete;
  /// The N coordinates.
  template <class... T>
    requires(N != Dynamic && sizeof...(T) == std::size_t(N) && (std::is_convertible_v<T, S> && ...))
  explicit(N == 1) vect(const T&... coordinates) : Base() {
    int i = 0;
    ((this->coeffRef(i++) = S(coordinates)), ...);
  }
  /// `n` zeros.
  explicit vect(Eigen::Index n)
    requires(N == Dynamic)
      : Base(Base::Zero(n)) {}
  /// The given coordinates, as in `vect<Dynamic>{1, 2, 3}`.
  vect(std::initializer_list<S> coordinates)
    requires(N == Dynamic)
      : Base(Eigen::Index(coordinates.size())) {
    Eigen::Index i = 0;
    for (const S& value : coordinates) this->coeffRef(i++) = value;
  }

  using Base::operator=;

  /// Entry I, for structured bindings.
  template <std::size_t I>
    requires(N > 0)
  const S& get() const {
    static_assert(I < std::size_t(N));
    return this->coeffRef(Eigen::Index(I));
  }

  // As Eigen's, whose expressions of expressions of dual numbers every program would compile anew.

  /// |x|^2
  S squaredNorm() const {
    if constexpr (std::is_arithmetic_v<S>) {
      return Base::squaredNorm();
    } else {
      if (this->size() == 0) return S(0.0);
      S sum = this->coeff(0) * this->coeff(0);
      detail::forEachEntry<(N > 0 ? N - 1 : Dynamic)>(this->size() - 1, [&](int i) {
        const S& x = this->coeff(i + 1);
        sum += x * x;
      });
      return sum;
    }
  }
  /// |x|
  S norm() const {
    using std::sqrt;
    return sqrt(squaredNorm());
  }

  int dof() const { return static_cast<int>(this->size()); }
  void boxplus(vectview<const S, N> d, S scale = S(1)) {
    detail::requireSameSize(*this, d, "x [+] d");
    Base::operator+=(scale* d);
  }
  void boxminus(vectview<S, N> out, const vect& y) const {
    detail::requireSameSize(*this, y, "x [-] y");
    out = *this - y;
  }
  void typicalSizes(vectview<S, N> out) const { out = this->cwiseAbs(); }
};

namespace detail {
/// A vector that also keeps its entries as what they were: structured bindings find numbers that depend on few unknowns.
template <class S, class... T>
class MixedVector : public vect<static_cast<int>(sizeof...(T)), S> {
 public:
  explicit MixedVector(const T&... entries)
      : vect<static_cast<int>(sizeof...(T)), S>(Uninitialized()), entries_(entries...) {
    Eigen::Index i = 0;
    ((this->coeffRef(i++) = entries), ...);
  }
  template <std::size_t I>
  const auto& get() const {
    return std::get<I>(entries_);
  }

 private:
  std::tuple<T...> entries_;
};
}  // namespace detail

/// The vector of these numbers, whose types may differ: the result's type holds them all. What a function that is to work
/// on numbers of any type returns: `return mtk::vector(u - z[0], v - z[1]);`
template <class First, class... Rest>
auto vector(const First& first, const Rest&... rest) {
  using Sum = typename detail::PromoteAll<First, Rest...>::type;
  using S = std::conditional_t<std::is_integral_v<Sum>, double, Sum>;
  if constexpr (detail::is_dual<S> && !(std::is_same_v<First, Rest> && ...)) {
    return detail::MixedVector<S, First, Rest...>(first, rest...);
  } else {
    vect<1 + static_cast<int>(sizeof...(Rest)), S> result{Uninitialized()};
    Eigen::Index i = 0;
    result[i++] = first;
    ((result[i++] = rest), ...);
    return result;
  }
}

// Arithmetic that gives values. Eigen's operators give expressions that refer to their operands, so that a function
// `auto f(...) { return T * p - z; }` would return a reference to the temporary T * p.

namespace detail {
/// A vector of type V whose `size` entries are still to be set.
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
/// The sum of an A and a B, as many entries as the one of fixed size has.
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
/// A number type other than S, one of the two not built in.
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
// By a built-in number of another type: the vector keeps its own.
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
// By a number of another type: vectors of numbers times dual numbers, dual numbers that depend on other unknowns.
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

namespace detail {
inline constexpr std::array<std::string_view, 2> xy_names{"x", "y"};
inline constexpr std::array<std::string_view, 3> xyz_names{"x", "y", "z"};
}  // namespace detail

}  // namespace mtk

// Structured bindings: `const auto& [fx, fy, cx, cy] = camera;`
template <int N, class S>
  requires(N > 0)
struct std::tuple_size<mtk::vect<N, S>> : std::integral_constant<std::size_t, N> {};
template <std::size_t I, int N, class S>
struct std::tuple_element<I, mtk::vect<N, S>> {
  using type = S;
};
template <class S, class... T>
struct std::tuple_size<mtk::detail::MixedVector<S, T...>>
    : std::integral_constant<std::size_t, sizeof...(T)> {};
template <std::size_t I, class S, class... T>
struct std::tuple_element<I, mtk::detail::MixedVector<S, T...>> : std::tuple_element<I, std::tuple<T...>> {};
