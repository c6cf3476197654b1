/// R^N: a column vector that can be a variable.
///   state    N scalars; mtk::Dynamic for a size known only at run time
///   tangent  the same N numbers; x [+] d = x + d, y [-] x = y - x
///   names    x, y, z for N = 2 and 3, otherwise 0, 1, ...
///   a + b, a - b, 2 * a are values: mtk/types/vect_arithmetic.hpp
/// To give the numbers a meaning, derive a type: `struct Camera : mtk::vect<9> { ... };`. A derived type can name its
/// components: `static constexpr std::array<std::string_view, 9> component_names{"fx", ...};` A type of run-time size
/// can name them by a member function `componentNames()` that returns one name for each entry.
#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include "mtk/detail/lanes.hpp"
#include "mtk/manifold.hpp"

namespace mtk {

namespace detail {
/// True if the Eigen vector D can have N entries.
template <class D, int N>
inline constexpr bool fits =
    bool(D::IsVectorAtCompileTime) &&
    (N == Dynamic || D::SizeAtCompileTime == Dynamic || int(D::SizeAtCompileTime) == N);
template <class D, int N>
  requires(!bool(D::IsVectorAtCompileTime))
inline constexpr bool fits<D, N> = D::SizeAtCompileTime == Dynamic;
}  // namespace detail

/// A tag for constructors: leaves the entries unset, because the caller fills them next.
struct Uninitialized {};

template <int N, class S = double>
class vect : public PlainVector<S, N> {
 public:
  using Base = PlainVector<S, N>;
  using scalar = S;
  static constexpr int DOF = N;

  /// Leaves all entries unset.
  explicit vect(Uninitialized)
    requires(N != Dynamic)
  {}
  /// Sets all entries to 0; if N is Dynamic, the size is 0.
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
  /// Converts coordinates of another type without loss, such as constants to dual numbers.
  template <class D>
    requires(!std::is_same_v<typename D::Scalar, S> && !std::is_arithmetic_v<S> &&
             std::is_convertible_v<typename D::Scalar, S> && detail::fits<D, N>)
  vect(const Eigen::MatrixBase<D>& v) : Base(v.size()) {  // NOLINT(google-explicit-constructor)
    for (Eigen::Index i = 0; i < v.size(); ++i) this->coeffRef(i) = S(v.derived()[i]);
  }
  /// Deleted, because conversion to numbers without derivatives would lose them. So a function of Eigen::Vector3d does
  /// not accept a vector of dual numbers.
  template <class D>
    requires(!std::is_arithmetic_v<S> && std::is_base_of_v<Eigen::PlainObjectBase<D>, D> &&
             std::is_arithmetic_v<typename D::Scalar>)
  operator D() const = delete;
  /// Sets the N coordinates.
  template <class... T>
    requires(N != Dynamic && sizeof...(T) == std::size_t(N) && (std::is_convertible_v<T, S> && ...))
  explicit(N == 1) vect(const T&... coordinates) : Base() {
    int i = 0;
    ((this->coeffRef(i++) = S(coordinates)), ...);
  }
  /// Creates `n` zeros.
  explicit vect(Eigen::Index n)
    requires(N == Dynamic)
      : Base(Base::Zero(n)) {}
  /// Sets the given coordinates, as in `vect<Dynamic>{1, 2, 3}`.
  vect(std::initializer_list<S> coordinates)
    requires(N == Dynamic)
      : Base(Eigen::Index(coordinates.size())) {
    Eigen::Index i = 0;
    for (const S& value : coordinates) this->coeffRef(i++) = value;
  }

  using Base::operator=;

  // Access to entries, as in Eigen's vectors. It avoids Eigen's lookup classes, which every program would compile for
  // every number type.

  using Base::operator[];
  /// Returns entry i, counted from 0.
  const S& operator[](Eigen::Index i) const { return entry(i); }
  S& operator[](Eigen::Index i) { return const_cast<S&>(entry(i)); }
  /// Returns entry 0.
  const S& x() const { return named<0>(); }
  S& x() { return const_cast<S&>(named<0>()); }
  /// Returns entry 1. Does not compile for shorter vectors.
  const S& y() const { return named<1>(); }
  S& y() { return const_cast<S&>(named<1>()); }
  /// Returns entry 2.
  const S& z() const { return named<2>(); }
  S& z() { return const_cast<S&>(named<2>()); }
  /// Returns entry 3.
  const S& w() const { return named<3>(); }
  S& w() { return const_cast<S&>(named<3>()); }

  /// Returns entry I, for structured bindings.
  template <std::size_t I>
    requires(N > 0)
  const S& get() const {
    static_assert(I < std::size_t(N));
    return this->coeffRef(Eigen::Index(I));
  }

  // Norms, as in Eigen's vectors. With Eigen's own, every program would compile nested expressions of dual numbers
  // anew.

  /// Returns |x|^2.
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
  /// Returns |x|.
  S norm() const {
    using std::sqrt;
    return sqrt(squaredNorm());
  }

  /// Returns the degrees of freedom: the number of entries.
  int dof() const { return static_cast<int>(this->size()); }
  void boxplus(vectview<const S, N> d, S scale = S(1)) {
    detail::requireSameSize(*this, d, "x [+] d");
    detail::addScaled(*this, scale, d);
  }
  void boxminus(vectview<S, N> out, const vect& y) const {
    detail::requireSameSize(*this, y, "x [-] y");
    detail::setDifference(out, *this, y);
  }
  /// Writes the magnitude of each entry; step tolerances are relative to it.
  void typicalSizes(vectview<S, N> out) const { detail::setMagnitudes(out, *this); }

 private:
  const S& entry(Eigen::Index i) const {
    eigen_assert(i >= 0 && i < this->size());
    return this->coeffRef(i);
  }
  template <int I>
  const S& named() const {
    static_assert(N == Dynamic || N > I, "mtk: this vector has fewer entries");
    return entry(I);
  }
};

namespace detail {
/// A vector that also keeps its entries in their original types. So structured bindings give numbers that depend on few
/// unknowns.
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

/// Returns the vector of these numbers. If their types differ, the result has a type that can hold all of them. Use it
/// in functions for numbers of any type: `return mtk::vector(u - z[0], v - z[1]);`
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

namespace detail {
template <int N, class S>
  requires(N > 0)
std::type_identity<vect<N, S>> vectOf(const vect<N, S>& x);
template <class D>
inline constexpr bool is_vect = false;
template <int N, class S>
inline constexpr bool is_vect<vect<N, S>> = true;
template <class S, class... T>
inline constexpr bool is_vect<MixedVector<S, T...>> = true;
/// A class that derives from a vect of fixed size and is not a vect itself.
template <class D>
concept DerivesFromVect = std::is_class_v<D> && !std::is_const_v<D> && !std::is_volatile_v<D> &&
                          !is_vect<D> && requires(const D& x) { vectOf(x); };

inline constexpr std::array<std::string_view, 2> xy_names{"x", "y"};
inline constexpr std::array<std::string_view, 3> xyz_names{"x", "y", "z"};
}  // namespace detail

}  // namespace mtk

// Structured bindings of vectors: `const auto& [fx, fy, cx, cy] = camera;`
template <int N, class S>
  requires(N > 0)
struct std::tuple_size<mtk::vect<N, S>> : std::integral_constant<std::size_t, std::size_t{N}> {};
template <std::size_t I, int N, class S>
struct std::tuple_element<I, mtk::vect<N, S>> {
  using type = S;
};
// Structured bindings of types derived from vect, such as `struct Camera : mtk::vect<9> {}`.
template <class D>
  requires mtk::detail::DerivesFromVect<D>
struct std::tuple_size<D>
    : std::tuple_size<typename decltype(mtk::detail::vectOf(std::declval<const D&>()))::type> {};
template <std::size_t I, class D>
  requires mtk::detail::DerivesFromVect<D>
struct std::tuple_element<I, D>
    : std::tuple_element<I, typename decltype(mtk::detail::vectOf(std::declval<const D&>()))::type> {};
template <class S, class... T>
struct std::tuple_size<mtk::detail::MixedVector<S, T...>>
    : std::integral_constant<std::size_t, sizeof...(T)> {};
template <std::size_t I, class S, class... T>
struct std::tuple_element<I, mtk::detail::MixedVector<S, T...>> : std::tuple_element<I, std::tuple<T...>> {};

#include "mtk/types/vect_arithmetic.hpp"
